from typing import Self, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

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

__all__ = ["ZigZag"]
