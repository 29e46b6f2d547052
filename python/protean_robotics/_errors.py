"""Exceptions of the package."""

import re
from typing import Any

#: Arguments that are True or False: options of the command without a value.
FLAGS = ("allow_external", "allow_outside", "copy", "force", "in_process", "quiet", "record", "retry_failed", "running")

# Words in quotes, which are an option, or stay as they are (commands); else an option, perhaps with the word for its value.
_OPTION = re.compile(r"`(?!--[a-z-]+`)[^`\n]*`|`?(?<![\w-])--([a-z][a-z-]*)(?: [A-Z]+\b)?`?")


def spelled(text: str) -> str:
    """Returns a text of the command with its options as arguments of Python, which have the same names."""

    def argument(found: re.Match[str]) -> str:
        if not found[1]:
            return found[0]
        name = found[1].replace("-", "_")
        return f"{name}=True" if name in FLAGS else f"`{name}`"

    return _OPTION.sub(argument, text)


class Error(Exception):
    """Failure of Protean."""

    __module__ = "protean_robotics"

    def __init__(self, text: str = "", *more: Any) -> None:
        super().__init__(spelled(text), *more)


class InvalidInput(Error, ValueError):
    """Scenario, file or argument that is invalid; the text names the field, the value and what is expected.

    It is also a ``ValueError``, and for a file that is missing a :class:`MissingFile`.
    """

    __module__ = "protean_robotics"

    def __new__(cls, text: str = "", *more: Any) -> "InvalidInput":
        if cls is InvalidInput and "(os error 2)" in text:
            return MissingFile.__new__(MissingFile, text, *more)
        return super().__new__(cls, text, *more)


class MissingFile(InvalidInput, FileNotFoundError):
    """A file that is missing."""

    __module__ = "protean_robotics"

    def __new__(cls, text: str = "", *more: Any) -> "MissingFile":
        return FileNotFoundError.__new__(cls, text, *more)
