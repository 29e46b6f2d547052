"""Path finding: ways past obstacles, arrival times, dominance regions."""

from . import _core

arrival_times = _core.navigation.arrival_times
dominance = _core.navigation.dominance
shortest_paths = _core.navigation.shortest_paths

__all__ = ["arrival_times", "dominance", "shortest_paths"]
