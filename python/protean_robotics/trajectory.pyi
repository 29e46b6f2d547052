from collections.abc import Sequence

from typing import Self, final

import numpy as np
from matplotlib.axes import Axes  # type: ignore[import-not-found, unused-ignore]
from numpy.typing import ArrayLike, NDArray

from ._types import Params, PoseLike

@final
class Trajectory:
    def __new__(
        cls,
        time: NDArray[np.float64],
        pose: NDArray[np.float64],
        v: NDArray[np.float64],
        omega: NDArray[np.float64],
        duration: float,
        lower_bound: float,
        length: float,
        status: str,
        obstacles: list[NDArray[np.float64]],
    ) -> Self: ...
    @property
    def time(self) -> NDArray[np.float64]: ...
    @property
    def pose(self) -> NDArray[np.float64]: ...
    @property
    def v(self) -> NDArray[np.float64]: ...
    @property
    def omega(self) -> NDArray[np.float64]: ...
    @property
    def duration(self) -> float: ...
    @property
    def lower_bound(self) -> float: ...
    @property
    def length(self) -> float: ...
    @property
    def status(self) -> str: ...
    @property
    def obstacles(self) -> list[NDArray[np.float64]]: ...
    def plot(self, *, ax: Axes | None = None) -> Axes: ...
    def _repr_html_(self) -> str: ...

def plan(
    start: PoseLike,
    goal: PoseLike,
    *,
    discs: ArrayLike | None = None,
    polygons: Sequence[ArrayLike] | None = ...,
    bounds: ArrayLike,
    v_max: float,
    omega_max: float,
    v_min: float | None = None,
    clearance: float = 0.0,
    start_speed: float | None = None,
    start_turn_rate: float | None = None,
    goal_speed: float | None = None,
    acceleration: float | None = None,
    angular_acceleration: float | None = None,
    wheels: ArrayLike | None = None,
    method: str = "bspline",
) -> Trajectory: ...
def plan_instance(instance: Params, *, options: Params | None = None) -> Trajectory: ...

__all__ = ["Trajectory", "plan", "plan_instance"]
