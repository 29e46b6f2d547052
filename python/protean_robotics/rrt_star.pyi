from typing import Self, final

import numpy as np
from numpy.typing import NDArray

from ._core import Map
from ._types import Params, PointLike, PoseLike

@final
class Tree:
    def __new__(
        cls,
        path: NDArray[np.float64],
        reached: bool,
        cost: float,
        nodes: NDArray[np.float64],
        parents: NDArray[np.int64],
        costs: NDArray[np.float64],
    ) -> Self: ...
    @property
    def path(self) -> NDArray[np.float64]: ...
    @property
    def reached(self) -> bool: ...
    @property
    def cost(self) -> float: ...
    @property
    def nodes(self) -> NDArray[np.float64]: ...
    @property
    def parents(self) -> NDArray[np.int64]: ...
    @property
    def costs(self) -> NDArray[np.float64]: ...

def plan(
    map: Map,
    start: PoseLike,
    goals: PointLike,
    radius: float,
    *,
    iterations: int = 1500,
    seed: int = 0,
    pursuers: PointLike | None = None,
    pursuer_speed: float = 1.0,
    v_max: float = 1.0,
    omega_max: float = ...,
    params: Params | None = None,
) -> Tree: ...

__all__ = ["Tree", "plan"]
