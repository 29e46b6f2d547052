import os
from collections.abc import Mapping
from typing import Any, Self, final

import numpy as np
from numpy.typing import NDArray

from ._core import Map
from ._types import PointLike

@final
class Plan:
    def __new__(
        cls,
        map: Map,
        start: PointLike,
        radius: float,
        *,
        key: str | None = None,
        seed: int = 0,
        sub_goals: int = 200,
        loops: int = 0,
        margin: float = 0.05,
        tolerance: float = 0.1,
    ) -> Self: ...
    def next(self, count: int) -> NDArray[np.float64]: ...
    @property
    def rectangles(self) -> NDArray[np.float64]: ...
    @property
    def bridges(self) -> NDArray[np.uint64]: ...
    @property
    def tour(self) -> NDArray[np.uint64]: ...
    @property
    def start(self) -> NDArray[np.float64]: ...
    @property
    def area(self) -> float: ...
    @property
    def key(self) -> str: ...

def plan(
    scenario: str | os.PathLike[str] = "coverage_open",
    *,
    process: str | None = None,
    loops: int | None = None,
    goals: int | None = None,
    length: float | None = None,
    seed: int | None = None,
    set: Mapping[str, Any] | None = None,
    allow_outside: bool = False,
) -> dict[str, Any]: ...

__all__ = ["Plan", "plan"]
