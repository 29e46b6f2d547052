"""The program `protean` of this package."""

import os
import shutil
import sys
import sysconfig
from pathlib import Path

from ._core import Error


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
