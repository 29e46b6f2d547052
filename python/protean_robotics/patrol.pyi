import os
from collections.abc import Mapping, Sequence
from typing import Any, Self, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._log import Log

@final
class ZigZag:
    def __new__(
        cls,
        contour: ArrayLike,
        *,
        t_max: float,
        alpha: float,
        key: str | None = None,
        seed: int = 0,
        closed: bool = True,
        preset: str = "default",
    ) -> Self: ...
    def lap(
        self, number: int = 0
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]: ...
    def predict(self, times: ArrayLike) -> NDArray[np.float64]: ...
    @property
    def key(self) -> str: ...
    @property
    def v(self) -> float: ...
    @property
    def length(self) -> float: ...
    @property
    def lap_time(self) -> float: ...
    @property
    def waypoints_per_lap(self) -> int: ...

def plan(
    scenario: str | os.PathLike[str] = "patrol_octagon",
    *,
    process: str | None = None,
    key: str | None = None,
    laps: int = 1,
    seed: int | None = None,
    set: Mapping[str, Any] | None = None,
    allow_outside: bool = False,
) -> dict[str, Any]: ...
def predict(
    scenario: str | os.PathLike[str] = "patrol_octagon",
    *,
    times: Sequence[float] = (),
    waypoints: Sequence[int] = (),
    process: str | None = None,
    key: str | None = None,
    seed: int | None = None,
    set: Mapping[str, Any] | None = None,
    allow_outside: bool = False,
) -> dict[str, Any]: ...
def detection(
    log: Log,
    *,
    duration: float,
    distance: float = 1.0,
    places: ArrayLike | None = None,
    robots: Sequence[str] | None = None,
    start: float = 0.0,
) -> dict[str, Any]: ...

__all__ = ["ZigZag", "detection", "plan", "predict"]
