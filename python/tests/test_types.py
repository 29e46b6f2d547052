"""The package, and the Python code of the documentation as a user's code, pass the checkers of types."""

import doctest
import importlib.util
import re
import subprocess
import sys
import textwrap
from pathlib import Path

import protean_robotics as pr
import pytest

ROOT = Path(__file__).parents[2]
PACKAGE = Path(pr.__file__).parent
PAGES = [ROOT / "README.md", ROOT / "python/README.md", *sorted(ROOT.glob("docs/**/*.md"))]
EXAMPLES = sorted(ROOT.glob("examples/python_planner/*.py"))
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)
DOCSTRING = re.compile(r'"""(.*?)"""', re.DOTALL)


def code_of(text: str) -> str:
    """Code of a block or a docstring: what follows the prompts, if there are any."""
    if ">>> " not in text:
        return textwrap.dedent(text)
    return "".join(example.source for example in doctest.DocTestParser().get_examples(text))


def lacks(source: str) -> bool:
    """True if code needs a package that is not here."""
    modules = re.findall(r"^\s*(?:import|from) (\w+)", source, re.MULTILINE)
    return any(importlib.util.find_spec(module) is None for module in modules)


def write() -> None:
    """Writes a module for the code of each page and of each docstring whose packages are here."""
    folder = Path("snippets")
    folder.mkdir()
    (folder / "__init__.py").touch()
    for page in PAGES:
        # The page of the API has the docstrings.
        blocks = BLOCK.findall(page.read_text())
        if page.name == "python.md":
            modules = [(f"{page.stem}_{i}", [block]) for i, block in enumerate(blocks)]
        else:
            modules = [(page.relative_to(ROOT).with_suffix("").as_posix(), blocks)]
        for name, parts in modules:
            sources = []
            for part in parts:
                file = re.match(r"# (\S+)\n", part)
                if file and file[1].endswith(".py"):
                    Path(file[1]).write_text(part)
                elif not file:
                    sources.append(code_of(part))
            if sources and not lacks("\n".join(sources)):
                module = re.sub(r"\W", "_", name)
                # Tests for pytest are written without types.
                tests = "# mypy: allow-untyped-defs\n" if "def test_" in "\n".join(sources) else ""
                (folder / f"{module}.py").write_text(tests + "\n".join(sources))
    for example in EXAMPLES:
        (folder / f"example_{example.name}").write_text(example.read_text())


def test_the_package_and_the_code_of_the_documentation_pass_mypy_and_pyright() -> None:
    write()
    assert len(list(Path("snippets").iterdir())) > 20
    checkers = [
        ["mypy", "--strict", "-p", "protean_robotics", "-p", "snippets"],
        ["pyright", "--pythonpath", sys.executable, "snippets", str(PACKAGE)],
    ]
    for checker in checkers:
        done = subprocess.run([sys.executable, "-m", *checker], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
