"""Minimum-time trajectories among obstacles."""

from . import _core

Trajectory = _core.trajectory.Trajectory
plan = _core.trajectory.plan
plan_instance = _core.trajectory.plan_instance

__all__ = ["Trajectory", "plan", "plan_instance"]
