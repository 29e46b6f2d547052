"""Files of maps: their names, texts and errors."""

import json
import os
from pathlib import Path

from ..._errors import InvalidInput

#: Maximum size of a text (bytes).
_MAX_TEXT = 256 << 20
#: Maximum length of a text in an error (characters).
_MAX_SHOWN = 60


class InvalidMap(InvalidInput):
    """A file that cannot become a scenario."""


def bad_line(path: Path, line: int, found: str, expected: str) -> InvalidInput:
    """Error of a line, from 1."""
    shown = json.dumps(found[:_MAX_SHOWN], ensure_ascii=False)
    return InvalidMap(f"{path}, line {line}: {shown}: expected {expected}")


def bad_content(path: Path, found: str, expected: str) -> InvalidInput:
    """Error of a file as a whole."""
    return InvalidMap(f"{path}: {found}: expected {expected}")


def extension(path: Path) -> str:
    """Extension of a path in lower case; empty if it has none."""
    return path.suffix[1:].lower()


def stem(path: Path) -> str:
    """Name of a file without its extension, other characters than letters, digits, ``.``, ``-`` and ``_`` replaced."""
    return "".join(c if c.isalnum() or c in ".-" else "_" for c in path.stem) or "world"


def lines(text: str) -> list[str]:
    """Lines of a text, without their ends."""
    found = [line.removesuffix("\r") for line in text.split("\n")]
    return found[:-1] if found[-1] == "" else found


def text(path: Path) -> str:
    """Text of a file, without its byte order mark."""
    try:
        if not path.is_file() and path.exists():
            raise InvalidMap(f"{path} is not a file: expected a file")
        with path.open("rb") as file:
            data = file.read(_MAX_TEXT + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InvalidMap(f"{path}: cannot be read: {reason}: expected a readable file") from None
    if len(data) > _MAX_TEXT:
        raise InvalidMap(f"{path} is too large: expected at most {_MAX_TEXT} bytes")
    try:
        return data.decode().removeprefix("\ufeff")
    except UnicodeDecodeError:
        raise InvalidMap(f"{path} is not text: expected UTF-8 text") from None


def text_beside(path: Path, other: str, allow_outside: bool) -> str:
    """Text of a file to which a file refers; outside its folder, also by a link, only with permission."""
    folder = path.parent
    outside = f"{path} refers to {other}: path leads out of the scenario's folder"
    if not other or "\0" in other:
        raise InvalidMap(f"{path} refers to {other}: not a path: expected the path of a file")
    if not allow_outside and (os.path.isabs(other) or ".." in Path(other).parts):
        raise InvalidMap(f"{outside}: expected a relative path without `..`")
    file = folder / other
    real = os.path.realpath(file)
    if not allow_outside and os.path.commonpath([real, os.path.realpath(folder)]) != os.path.realpath(folder):
        raise InvalidMap(f"{outside}, to {real}: expected a file inside the folder")
    try:
        return text(Path(real))
    except InvalidMap as error:
        raise InvalidMap(f"{path} refers to {other}: {error}") from None
