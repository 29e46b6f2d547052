"""Missions of mobile robots: run them, read their logs, write planners."""

from ._core import Error, InvalidInput, Map, __version__

__all__ = ["Error", "InvalidInput", "Map", "__version__"]
