"""Path finding: ways past obstacles, arrival times, dominance regions."""

from . import _core

arrival_times = _core.navigation.arrival_times
dominance = _core.navigation.dominance
ways = _core.navigation.ways

__all__ = ["arrival_times", "dominance", "ways"]
