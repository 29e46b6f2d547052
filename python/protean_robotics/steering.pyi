from typing import Self, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import Map, Scan
from ._types import Params, PointLike, PoseLike

def go_to(
    pose: PoseLike,
    target: PointLike,
    *,
    v_max: float,
    omega_max: float,
    dt: float,
    v_reverse_max: float = 0.0,
    params: Params | None = None,
) -> tuple[float, float]: ...
def attraction(
    points: PointLike, goals: PointLike, weights: ArrayLike | None = None
) -> NDArray[np.float64]: ...
def repulsion(
    points: PointLike,
    robots: PointLike,
    weights: ArrayLike | None = None,
    *,
    params: Params | None = None,
) -> NDArray[np.float64]: ...
def obstacle_push(
    map: Map, points: PointLike, *, published: bool = False
) -> NDArray[np.float64]: ...
def linearise(
    velocity: ArrayLike,
    heading: float,
    *,
    v_max: float,
    omega_max: float,
    v_reverse_max: float = 0.0,
    params: Params | None = None,
) -> tuple[float, float]: ...

@final
class TangentBug:
    def __new__(cls, radius: float) -> Self: ...
    def advise(
        self,
        pose: PoseLike,
        ranges: ArrayLike | Scan,
        goal: PointLike,
        *,
        angles: ArrayLike | None = None,
        range_max: float | None = None,
        tolerance: float = 0.05,
    ) -> tuple[NDArray[np.float64], str] | None: ...
    def reset(self) -> None: ...

@final
class PathTracker:
    def __new__(cls, path: ArrayLike, *, params: Params | None = None) -> Self: ...
    def track(
        self, pose: PoseLike, *, v_max: float, omega_max: float, v_reverse_max: float = 0.0
    ) -> tuple[float, float]: ...
    @property
    def arrived(self) -> bool: ...
    @property
    def progress(self) -> float: ...
    @property
    def length(self) -> float: ...

__all__ = [
    "PathTracker",
    "TangentBug",
    "attraction",
    "go_to",
    "linearise",
    "obstacle_push",
    "repulsion",
]
