"""XML documents, each element with its line, read in linear time."""

import re
from collections.abc import Iterator
from pathlib import Path
from xml.parsers import expat

from .files import InvalidMap, bad_content, bad_line

#: Maximum number of attributes of an element, and of namespace declarations of a file.
_MAX_ATTRIBUTES = 256
_NUMBER = re.compile(r"[+-]?(inf|infinity|nan|([0-9]+\.?[0-9]*|\.[0-9]+)(e[+-]?[0-9]+)?)", re.IGNORECASE)


class Element:
    """An element: its local name, attributes, line, children, and the text before the first child."""

    __slots__ = ("attributes", "children", "line", "name", "text")

    def __init__(self, name: str, attributes: dict[str, str], line: int) -> None:
        self.name: str = name.rpartition(" ")[2]
        self.attributes: dict[str, str] = attributes
        self.line: int = line
        self.children: list[Element] = []
        self.text: str = ""

    def named(self, name: str) -> Iterator["Element"]:
        """Children with this name."""
        return (child for child in self.children if child.name == name)


def elements(path: Path, text: str) -> list[Element]:
    """All elements of a document in its order, the root first.

    Raises
    ------
    InvalidInput
        The text is not XML, has a document type, or an element or the file has too many attributes.
    """
    found: list[Element] = []
    above: list[Element] = []
    declarations = 0
    parser = expat.ParserCreate(namespace_separator=" ")

    def start(name: str, attributes: dict[str, str]) -> None:
        element = Element(name, attributes, parser.CurrentLineNumber)
        if len(attributes) > _MAX_ATTRIBUTES:
            tag = f"{element.name} " + " ".join(f"{key}='{value}'" for key, value in attributes.items())
            expected = f"at most {_MAX_ATTRIBUTES} attributes of an element"
            raise bad_line(path, element.line, tag, expected)
        if above:
            above[-1].children.append(element)
        above.append(element)
        found.append(element)

    def end(_name: str) -> None:
        above.pop()

    def characters(more: str) -> None:
        if not above[-1].children:
            above[-1].text += more

    def declaration(_prefix: str | None, _uri: str) -> None:
        nonlocal declarations
        declarations += 1
        if declarations > _MAX_ATTRIBUTES:
            raise bad_content(path, f"more than {_MAX_ATTRIBUTES} declarations `xmlns`", "fewer")

    def document_type(*_names: object) -> None:
        # Its entities could multiply the text.
        raise bad_line(path, parser.CurrentLineNumber, "<!DOCTYPE", "XML without a document type")

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = characters
    parser.StartNamespaceDeclHandler = declaration
    parser.StartDoctypeDeclHandler = document_type
    parser.buffer_text = True
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        raise InvalidMap(f"{path}: {error}: expected XML") from None
    return found


def number(text: str | None) -> float | None:
    """A decimal number, without space around it; else None."""
    return float(text) if text is not None and _NUMBER.fullmatch(text) else None
