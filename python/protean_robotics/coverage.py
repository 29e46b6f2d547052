"""Coverage of a workplace by sub-goals."""

from . import _core

Plan = _core.coverage.Plan

__all__ = ["Plan"]
