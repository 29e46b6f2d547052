"""Steering of differential-drive robots: fields, linearisation, drives to points, along paths and around obstacles."""

from . import _core

PathTracker = _core.steering.PathTracker
TangentBug = _core.steering.TangentBug
attraction = _core.steering.attraction
go_to = _core.steering.go_to
linearise = _core.steering.linearise
obstacle_push = _core.steering.obstacle_push
repulsion = _core.steering.repulsion

__all__ = [
    "PathTracker",
    "TangentBug",
    "attraction",
    "go_to",
    "linearise",
    "obstacle_push",
    "repulsion",
]
