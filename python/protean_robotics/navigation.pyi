import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import Map
from ._types import PointLike

def shortest_paths(
    map: Map,
    start: PointLike,
    goal: PointLike,
    radius: float,
    *,
    count: int = 3,
    max_length: float | None = None,
) -> list[NDArray[np.float64]]: ...
def arrival_times(
    map: Map, starts: PointLike, speeds: ArrayLike, radius: float, *, pitch: float | None = None
) -> NDArray[np.float32]: ...
def dominance(
    map: Map,
    evaders: PointLike,
    evader_speeds: ArrayLike,
    pursuers: PointLike,
    pursuer_speeds: ArrayLike,
    *,
    radius: float,
    capture_radius: float = 0.0,
    pitch: float | None = None,
) -> NDArray[np.uint8]: ...

__all__ = ["arrival_times", "dominance", "shortest_paths"]
