"""The program `protean` of this package."""

import json
import os
import shutil
import signal
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ._arguments import refused
from ._errors import Error, InvalidInput, spelled

#: Exit code of the command for input that is invalid; nothing has been started.
_INVALID = 2
#: Exit code of the command for a result that is not whole: a process or mission failed, or messages were lost.
_PARTIAL = 3


def program() -> Path:
    """Path of the program `protean`: of this package, else the one in PATH.

    The environment variable PROTEAN_PROGRAM takes precedence.

    Raises
    ------
    Error
        There is none.
    """
    named = os.environ.get("PROTEAN_PROGRAM")
    if named:
        return Path(named)
    package = Path(__file__).resolve().parent
    folders = [
        Path(sysconfig.get_path("scripts")),
        Path(sys.executable).parent,
        # `pip install --user` and `pip install --target`.
        Path(sysconfig.get_path("scripts", f"{os.name}_user")),
        package.parent / "bin",
    ]
    for folder in folders:
        path = folder / "protean"
        if path.is_file():
            return path
    found = shutil.which("protean")
    if found is None:
        places = ", ".join(str(folder) for folder in folders)
        raise Error(f"no program protean in {places} or PATH: expected one of the wheel protean-robotics")
    return Path(found)


def json_of(arguments: list[str], children: list["subprocess.Popen[str]"] | None = None) -> dict[str, Any]:
    """Runs a command of `protean`, shows its messages as they come, and returns the JSON object that it prints.

    As long as it runs, it is in ``children``.

    Raises
    ------
    InvalidInput
        The command refuses its input.
    Error
        The command failed.
    KeyboardInterrupt
        After Ctrl-C, which ended the command in order.
    """
    # Programs of a scenario find the interpreter and packages of this process first.
    folder = str(Path(sys.executable).parent)
    environment = os.environ | {"PATH": folder + os.pathsep + os.environ.get("PATH", os.defpath)}
    with tempfile.TemporaryFile("w+", encoding="utf-8") as output:
        # In a group of its own, so that Ctrl-C reaches it once, from here.
        with subprocess.Popen(
            [str(program()), *arguments, "--json"],
            stdout=output,
            stderr=subprocess.PIPE,
            text=True,
            env=environment,
            process_group=0,
        ) as process:
            assert process.stderr is not None
            refusal = ""
            children = [] if children is None else children
            children.append(process)
            try:
                for line in process.stderr:
                    # From the first error on, lines are the text of an exception.
                    if refusal or line.startswith("error"):
                        refusal += line
                    else:
                        print(spelled(line), end="", file=sys.stderr, flush=True)
                process.wait()
            except BaseException:
                process.send_signal(signal.SIGINT)
                process.communicate()
                raise
            finally:
                children.remove(process)
        output.seek(0)
        text = output.read()
    if process.returncode in (0, _PARTIAL) and text:
        print(spelled(refusal), end="", file=sys.stderr)
        report: dict[str, Any] = json.loads(text)
        return report
    refusal = refusal.strip().removeprefix("error: ") or f"{arguments[0]}: exit code {process.returncode}"
    raise InvalidInput(refusal) if process.returncode == _INVALID else Error(refusal)


def toml(name: str, value: Any) -> str:
    """Writes the value of an argument as in TOML."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{json.dumps(str(key))} = {toml(name, item)}" for key, item in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml(name, item) for item in value) + "]"
    if isinstance(value, (np.ndarray, np.generic)):
        return toml(name, value.tolist())
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    if isinstance(value, (bool, str)):
        return json.dumps(value)
    if isinstance(value, (int, float)):
        return repr(value)
    raise refused(name, value, "a number, a text, True, False, or lists or mappings of them")


def overrides(values: Mapping[str, Any] | None) -> list[str]:
    """Writes values by their dotted keys, as `--set` takes them."""
    return [f"{key}={toml(f'set: {key}', value)}" for key, value in (values or {}).items()]
