"""``python -m protean_robotics``: the program `protean` of this package."""

import os
import sys

from ._errors import Error
from ._program import program


def _main() -> None:
    try:
        path = program()
    except Error as error:
        raise SystemExit(f"error: {error}") from None
    os.execv(path, ["protean", *sys.argv[1:]])


if __name__ == "__main__":
    _main()
