"""Pickling of the package's objects, for other processes and copies.

What follows from its arguments is made again from them; the rest is refused in words.
"""

import copyreg
import functools
import os
from collections.abc import Callable
from types import BuiltinFunctionType
from typing import Any, NoReturn, TypeVar

import numpy as np
from numpy.typing import NDArray

from . import coverage, navigation, patrol, rrt_star, steering, tracking, trajectory
from ._core import Belief, LogFile, Map, Robot, Scan, Steering, World

_T = TypeVar("_T")

#: Attributes of results, in the order of the arguments that make them.
_RESULTS: dict[type, tuple[str, ...]] = {
    Steering: ("v", "omega", "target", "aim", "waypoint"),
    rrt_star.Tree: ("path", "reached", "cost", "nodes", "parents", "costs"),
    trajectory.Trajectory: ("time", "pose", "v", "omega", "duration", "lower_bound", "length", "status", "obstacles"),
}
_OF_A_TICK = "its values are those of a tick of a run: expected a copy of those that are needed"
_STATE = "it has a state: expected one made by its arguments in the other process"
#: Why objects of a class are not pickled.
_REFUSALS: dict[type, str] = dict.fromkeys((Belief, Robot, Scan, World), _OF_A_TICK) | dict.fromkeys(
    (coverage.Plan, patrol.ZigZag, steering.PathTracker, steering.TangentBug, tracking.ParticleFilter), _STATE
)


def remade(cls: type[_T]) -> type[_T]:
    """Makes the objects of a class picklable: their copies are made by the same arguments, without their state."""
    own: Any = cls
    initialise = own.__init__

    @functools.wraps(initialise)
    def init(self: Any, *args: Any, **kwargs: Any) -> None:
        self._made_by = (args, kwargs)
        initialise(self, *args, **kwargs)

    def reduce(self: Any) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        args, kwargs = self._made_by
        if type(self) is not cls:
            raise TypeError(f"cannot pickle a {type(self).__name__}: expected __reduce__ in the class")
        return _make, (cls, args, kwargs)

    own.__init__ = init
    own.__reduce__ = reduce
    return cls


def _make(cls: type, args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
    return cls(*args, **kwargs)


def _result(cls: type, names: tuple[str, ...], values: tuple[Any, ...]) -> Any:
    return cls(**dict(zip(names, values, strict=True)))


def _refuse(reason: str, given: Any) -> NoReturn:
    raise TypeError(f"cannot pickle a {type(given).__name__}: {reason}")


def _map(given: Map) -> tuple[Callable[..., Map], tuple[Any, ...]]:
    if given._recipe is None:
        _refuse("it is the map of a run: expected one made by its source in the other process", given)
    source, blur_sigma = given._recipe
    if source is not None:
        return Map, (source,)
    return _of_grid, (given.grid, given.resolution, given.origin, blur_sigma)


def _of_grid(grid: NDArray[np.bool_], resolution: float, origin: NDArray[np.float64], blur_sigma: float) -> Map:
    return Map.from_grid(grid, resolution, origin, blur_sigma=blur_sigma)


def _file(path: str) -> LogFile:
    return LogFile(path)


def register() -> None:
    """Makes the compiled classes known to `pickle` and `copy`."""
    for module in (coverage, navigation, patrol, rrt_star, steering, tracking, trajectory):
        for name in module.__all__:
            # Functions travel by the name of a module that can be imported.
            function = getattr(module, name)
            if isinstance(function, BuiltinFunctionType):
                function.__module__ = module.__name__
    for cls, names in _RESULTS.items():
        copyreg.pickle(cls, functools.partial(_values, cls, names))
    for cls, reason in _REFUSALS.items():
        copyreg.pickle(cls, functools.partial(_refuse, reason))
    copyreg.pickle(Map, _map)
    copyreg.pickle(LogFile, lambda file: (_file, (os.path.abspath(file.path),)))


def _values(cls: type, names: tuple[str, ...], given: Any) -> tuple[Callable[..., Any], tuple[Any, ...]]:
    return _result, (cls, names, tuple(getattr(given, name) for name in names))
