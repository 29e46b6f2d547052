"""Patrols along a contour."""

from . import _core

ZigZag = _core.patrol.ZigZag

__all__ = ["ZigZag"]
