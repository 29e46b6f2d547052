"""The page of the API in the documentation is that of the docstrings.

`PROTEAN_DOCS=write pytest test_reference.py` writes it.
"""

import importlib
import importlib.util
import inspect
import os
import sys
from pathlib import Path
from types import ModuleType
from typing import Any
from unittest.mock import patch

import protean_robotics as pr

PAGE = Path(__file__).parents[2] / "docs/reference/python.md"

HEAD = """# Python package

`import protean_robotics as pr`. Lengths are in metres, times in seconds, angles in radians, counter-clockwise; x points
forward, y to the left. This page is made from the docstrings (`help(pr.run)`).

**Ctrl-C** ends every call within a second. A run or a sweep keeps what it has written. Environments that it ends in a step or a reset
must be reset. What an algorithm computes is dropped; its thread goes on until it has computed it, without an effect, also while the
interpreter ends.

**Other processes** of any start method (fork, spawn, forkserver) get objects by `pickle`: what follows from its arguments is made again
from them, an environment without its episode. Robots and other inputs of a planner, and algorithms with a state, are refused with a
reason. A forked child makes its own environments.

**Limits** of scenarios hold for arguments: 64 robots, 1024 exits or goals, 4096 beams, 25 million cells of a map; 65 536 instances of an
environment. What is beyond is an `InvalidInput`.
"""


def signature(name: str, value: Any) -> str:
    """Name and arguments; the types stand in the text below."""
    try:
        found = inspect.signature(value)
    except (TypeError, ValueError):
        return name
    arguments = [
        argument.replace(annotation=argument.empty)
        for argument in found.parameters.values()
        if argument.name != "self" and argument.kind is not argument.POSITIONAL_ONLY
    ]
    return name + str(found.replace(parameters=arguments, return_annotation=found.empty))


def sections(text: str) -> list[str]:
    """Lines of a docstring in Markdown: its underlined headings in bold, lists of values as lists, examples as code."""
    lines: list[str] = []
    rows = inspect.cleandoc(text).replace("``", "`").splitlines()
    heading = ""
    for index, row in enumerate(rows):
        below = rows[index + 1] if index + 1 < len(rows) else ""
        if row and set(row) == {"-"} and heading:
            continue
        if row and below and set(below) == {"-"} and len(below) >= 3:
            heading = row
            lines += [f"**{row}**", ""]
            if row == "Examples":
                lines.append("```python")
        elif heading and heading != "Examples" and row and not row.startswith(" "):
            lines.append(f"- `{row}`")
        else:
            lines.append(row)
    while lines and not lines[-1]:
        lines.pop()
    if heading == "Examples":
        lines.append("```")
    return lines


def entry(level: int, name: str, value: Any) -> list[str]:
    text = inspect.getdoc(value) or ""
    call = callable(value) and not (inspect.isclass(value) and issubclass(value, Exception))
    lines = [f"{'#' * level} `{signature(name, value) if call else name}`", "", *sections(text), ""]
    if inspect.isclass(value) and not issubclass(value, Exception):
        for attribute in sorted(vars(value)):
            if attribute.startswith("_"):
                continue
            item = getattr(value, attribute)
            document = inspect.getdoc(item)
            assert document, f"{name}.{attribute} has no docstring"
            if callable(item) and not isinstance(item, property):
                lines += ["", f"{'#' * (level + 1)} `{name}.{signature(attribute, item)}`", "", *sections(document), ""]
            else:
                first = document.replace("``", "`").split("\n\n")[0]
                lines += [f"- `{name}.{attribute}`: {' '.join(first.split())}"]
        lines.append("")
    return lines


def sb3() -> ModuleType:
    """The module for stable-baselines3; without the library, with an empty class in the place of its own."""
    if importlib.util.find_spec("stable_baselines3"):
        return pr.sb3
    folder = "stable_baselines3.common.vec_env"
    library = ModuleType(folder)
    vars(library)["VecEnv"] = type("VecEnv", (), {})
    with patch.dict(sys.modules, dict.fromkeys(["stable_baselines3", "stable_baselines3.common", folder], library)):
        module = importlib.import_module("protean_robotics.sb3")
    del pr.sb3
    return module


def page() -> str:
    lines = [HEAD]
    modules: list[tuple[str, ModuleType]] = []
    for name in sorted({*pr.__all__, *pr._GYM}):
        value = getattr(pr, name)
        if name.startswith("__"):
            continue
        if isinstance(value, ModuleType):
            modules.append((name, value))
        else:
            assert inspect.getdoc(value), f"{name} has no docstring"
            lines += entry(2, f"pr.{name}", value)
    for name, module in sorted([*modules, ("sb3", sb3())]):
        lines += [f"## `pr.{name}`", "", *sections(module.__doc__ or ""), ""]
        for item in module.__all__:
            assert inspect.getdoc(getattr(module, item)), f"{name}.{item} has no docstring"
            lines += entry(3, f"pr.{name}.{item}", getattr(module, item))
    text = "\n".join(lines)
    while "\n\n\n" in text:
        text = text.replace("\n\n\n", "\n\n")
    return text.rstrip() + "\n"


def test_the_page_of_the_api_is_that_of_the_docstrings() -> None:
    if os.environ.get("PROTEAN_DOCS") == "write":
        PAGE.write_text(page())
    assert PAGE.read_text() == page(), "write it: PROTEAN_DOCS=write pytest python/tests/test_reference.py"
