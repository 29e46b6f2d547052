"""Steering of differential-drive robots."""

from . import _core

go_to = _core.steering.go_to

__all__ = ["go_to"]
