"""Paths by RRT*."""

from . import _core

Tree = _core.rrt_star.Tree
plan = _core.rrt_star.plan

__all__ = ["Tree", "plan"]
