"""Logs of runs."""

import os
from pathlib import Path


class Log:
    """A log.

    Attributes
    ----------
    path
        Path of the file.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
