"""Checks of arguments. What is wrong is an :class:`InvalidInput` that names the argument, its value and what is expected."""

import functools
import inspect
import operator
import os
import reprlib
from collections.abc import Callable, Iterable, Mapping
from typing import Any, ParamSpec, TypeVar

import numpy as np

from ._core import MAX_MISSIONS
from ._errors import FLAGS, InvalidInput

_P = ParamSpec("_P")
_R = TypeVar("_R")

_MAX_COUNT = 2**32 - 1
_MAX_SEED = 2**64 - 1


def refused(name: str, value: object, expected: str) -> InvalidInput:
    """Returns the exception for an argument."""
    return InvalidInput(f"{name} = {reprlib.repr(value)}: expected {expected}")


def whole(name: str, value: Any, least: int, most: int) -> int:
    """Returns a whole number of a range."""
    try:
        number = operator.index(value)
    except TypeError:
        number = -1
    if not least <= number <= most:
        raise refused(name, value, f"a whole number from {least} to {most}")
    return number


def count(name: str, value: Any) -> int:
    """Returns a number of things, at least 1."""
    return whole(name, value, 1, _MAX_COUNT)


def index(name: str, value: Any) -> int:
    """Returns an index."""
    return whole(name, value, 0, _MAX_COUNT)


def seed(name: str, value: Any) -> int:
    """Returns a seed."""
    return whole(name, value, 0, _MAX_SEED)


def seeds(name: str, value: Any) -> list[int]:
    """Returns seeds, at least one: of a range, a list or an array."""
    found = [seed(name, item) for item in _items(name, value, "seeds, at least one")]
    if not found:
        raise refused(name, value, "seeds, at least one")
    return found


def number(name: str, value: Any) -> float:
    """Returns a number."""
    if isinstance(value, str):
        raise refused(name, value, "a number")
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise refused(name, value, "a number") from None


def flag(name: str, value: Any) -> bool:
    """Returns a truth value."""
    if not isinstance(value, (bool, np.bool_)):
        raise refused(name, value, "True or False")
    return bool(value)


def text(name: str, value: Any) -> str:
    """Returns a text."""
    if not _is_text(value):
        raise refused(name, value, "a text")
    found: str = value
    return found


def texts(name: str, value: Any) -> list[str]:
    """Returns a list of texts."""
    expected = "a list of names"
    found = list(_items(name, value, expected))
    if not all(map(_is_text, found)):
        raise refused(name, value, expected)
    return found


def path(name: str, value: Any) -> str:
    """Returns a path, or the name of a built-in scenario."""
    found = os.fspath(value) if isinstance(value, os.PathLike) else value
    if not _is_text(found) or "\0" in found:
        raise refused(name, value, "a path")
    return str(found)


def mapping(name: str, value: Any) -> Mapping[str, Any]:
    """Returns a mapping of texts."""
    if not isinstance(value, Mapping) or not all(map(_is_text, value)):
        raise refused(name, value, "a mapping of names to values")
    return value


def function(name: str, value: Any) -> Callable[..., Any]:
    """Returns a function."""
    if not callable(value):
        raise refused(name, value, "a function")
    found: Callable[..., Any] = value
    return found


def _is_text(value: object) -> bool:
    """True for a text without lone surrogates, which no file and no argument can have."""
    if not isinstance(value, str):
        return False
    try:
        value.encode()
    except UnicodeEncodeError:
        return False
    return True


def _items(name: str, value: Any, expected: str) -> Iterable[Any]:
    if isinstance(value, (str, bytes, Mapping)):
        raise refused(name, value, expected)
    # More than any argument may have, a range of 2**60 for example, would not fit into the memory.
    if operator.length_hint(value) > MAX_MISSIONS:
        raise refused(name, value, f"at most {MAX_MISSIONS}")
    try:
        return list(value)
    except TypeError:
        raise refused(name, value, expected) from None


#: Checks by the names of arguments, which have one meaning in the whole package.
_CHECKS: dict[str, Callable[[str, Any], Any]] = {
    "action": text,
    "agents": texts,
    "at": number,
    "command": mapping,
    "continuations": count,
    "draw": mapping,
    "duration": number,
    "experiment": path,
    "fps": number,
    "goals": count,
    "i": index,
    "jobs": count,
    "keep_logs": text,
    "key": text,
    "laps": count,
    "length": number,
    "loops": count,
    "moments": count,
    "num_envs": count,
    "observation": text,
    "out": path,
    "path": path,
    "place": mapping,
    "planners": mapping,
    "process": text,
    "quantity": text,
    "replace": mapping,
    "reseed": texts,
    "scenario": path,
    "seed": seed,
    "seeds": seeds,
    "set": mapping,
    "shards": count,
    "share": number,
    "speed": number,
    "suggest": function,
    "threads": count,
    "ticks_per_action": count,
    "value": function,
    "worst": text,
} | dict.fromkeys(FLAGS, flag)


def checked(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Makes a function check its arguments; None is left as it is where it is the default."""
    signature = inspect.signature(function)
    checks = {name: _CHECKS[name] for name in signature.parameters if name in _CHECKS}
    optional = {name for name in checks if signature.parameters[name].default is None}

    @functools.wraps(function)
    def call(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        bound = signature.bind(*args, **kwargs)
        given = bound.arguments
        for name, check in checks.items():
            if name in given and not (given[name] is None and name in optional):
                given[name] = check(name, given[name])
        return function(*bound.args, **bound.kwargs)

    return call
