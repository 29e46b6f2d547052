"""The examples in the documentation of all functions and classes."""

import doctest
import inspect
from types import ModuleType
from typing import Any

import protean_robotics as pr
import pytest


def modules() -> list[ModuleType]:
    named = [getattr(pr, name) for name in pr.__all__]
    return [pr, *(m for m in named if inspect.ismodule(m))]


def exported() -> list[tuple[str, Any]]:
    found = []
    for module in modules():
        for name in getattr(module, "__all__", ()):
            value = getattr(module, name)
            if inspect.isroutine(value) or inspect.isclass(value):
                found.append((f"{module.__name__}.{name}", value))
    return found


def documented(value: Any) -> list[tuple[str, Any]]:
    """The value, and the members of a class that it defines itself."""
    own = [("", value)]
    if inspect.isclass(value):
        own += [(f".{name}", member) for name, member in vars(value).items()]
    return own


@pytest.mark.parametrize("name,value", exported(), ids=[name for name, _ in exported()])
def test_examples_run(name: str, value: Any) -> None:
    runner = doctest.DocTestRunner()
    parser = doctest.DocTestParser()
    for suffix, member in documented(value):
        text = getattr(member, "__doc__", None) or ""
        test = parser.get_doctest(text, {}, name + suffix, None, None)
        result = runner.run(test)
        assert result.failed == 0, f"{name}{suffix}"
