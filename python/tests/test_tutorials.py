"""The Python code of the tutorials and of the README runs, and prints what they say."""

import re
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
TUTORIALS = ("python-students", "python-researchers", "python-engineers")


@pytest.mark.parametrize("name", ["README", *(f"docs/tutorials/{name}" for name in TUTORIALS)])
def test_the_code_of_a_tutorial_runs(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.syspath_prepend(Path.cwd())
    text = (ROOT / f"{name}.md").read_text()
    names: dict[str, Any] = {"__name__": "tutorial"}
    code = re.findall(r"```python\n(.*?)```(?:\n+It prints:\n+```text\n(.*?)```)?", text, re.DOTALL)
    assert code, f"{name} has no code"
    for source, printed in code:
        file = re.match(r"# (\S+\.(?:py|toml))\n", source)
        if file:
            # A file that the following code uses.
            Path(file[1]).write_text(source)
            continue
        capsys.readouterr()
        exec(compile(source, f"{name}.md", "exec"), names)
        assert capsys.readouterr().out == printed
    sys.modules.pop("planner", None)
