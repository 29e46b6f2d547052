"""The examples in the documentation of what is compiled; pytest finds those of the Python modules by itself."""

import doctest
import inspect
from types import ModuleType
from typing import Any

import pytest
from protean_robotics import _core


def compiled(module: ModuleType) -> list[tuple[str, Any]]:
    """The functions and classes of a module and of those in it, with the members of classes."""
    found: list[tuple[str, Any]] = []
    for name, value in vars(module).items():
        if inspect.ismodule(value):
            found += [(f"{name}.{inner}", item) for inner, item in compiled(value)]
        elif inspect.isroutine(value):
            found.append((name, value))
        elif inspect.isclass(value):
            found.append((name, value))
            found += [(f"{name}.{member}", item) for member, item in vars(value).items()]
    return found


EXAMPLES = [(name, item.__doc__) for name, item in compiled(_core) if ">>>" in str(item.__doc__)]


def test_there_are_examples() -> None:
    assert {"Map.path", "steering.go_to", "trajectory.plan"} <= {name for name, _ in EXAMPLES}


@pytest.mark.parametrize("name,text", EXAMPLES, ids=[name for name, _ in EXAMPLES])
def test_examples_run(name: str, text: str) -> None:
    test = doctest.DocTestParser().get_doctest(text, {}, name, None, None)
    assert doctest.DocTestRunner().run(test).failed == 0
