from typing import Any, Self, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import Map
from ._types import Params, PointLike, PoseLike

@final
class ParticleFilter:
    def __new__(
        cls,
        map: Map,
        start: PoseLike | None = None,
        *,
        v_max: float,
        omega_max: float,
        v_reverse_max: float = 0.0,
        seed: int = 0,
        params: Params | None = None,
    ) -> Self: ...
    def update(
        self,
        dt: float,
        position: PointLike | None = None,
        *,
        sigma: float = 0.0,
        heading: float | None = None,
        heading_sigma: float = 0.0,
        observers: ArrayLike | None = None,
        sensor: Params | None = None,
    ) -> None: ...
    @property
    def particles(self) -> NDArray[np.float32]: ...
    @property
    def mean(self) -> NDArray[np.float64]: ...
    @property
    def covariance(self) -> NDArray[np.float64]: ...
    @property
    def heading_spread(self) -> float: ...
    @property
    def effective_sample_size(self) -> float: ...
    @property
    def unseen_for(self) -> float: ...
    @property
    def rebuilt(self) -> int: ...
    def __len__(self) -> int: ...

# A number for one point, an array for several.
def visibility(
    map: Map, observers: ArrayLike, points: PointLike, *, sensor: Params | None = None
) -> Any: ...

__all__ = ["ParticleFilter", "visibility"]
