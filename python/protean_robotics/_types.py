"""Types of arguments."""

from collections.abc import Mapping
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray


class HasPosition(Protocol):
    """An object with a position (m), shape (2,): a :class:`Robot`."""

    @property
    def position(self) -> NDArray[np.float64]:
        """Position (m), shape (2,)."""
        ...


class HasPose(Protocol):
    """An object with a pose, shape (3,): a :class:`Robot`."""

    @property
    def pose(self) -> NDArray[np.float64]:
        """Pose: x (m), y (m), heading (rad), shape (3,)."""
        ...


PointLike: TypeAlias = ArrayLike | HasPosition
"""Points (m), or an object with a position."""

PoseLike: TypeAlias = ArrayLike | HasPose
"""A pose, or an object with one."""

Params: TypeAlias = Mapping[str, object]
"""Parameters by name; absent ones have their defaults."""
