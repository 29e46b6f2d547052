"""Street graphs in GraphML, as OSMnx and NetworkX write them."""

import math
import re
from collections.abc import Iterator
from pathlib import Path

from . import xml
from .files import bad_content, bad_line
from .plane import Streets
from .world import Point

#: Names of the coordinates of a node, and whether they are degrees.
_COORDINATES = (
    ("x", "y", False),
    ("lon", "lat", True),
    ("longitude", "latitude", True),
    ("Longitude", "Latitude", True),
)
#: Lines in well-known text (OGC 06-103r4), as shapely and PostGIS write them.
_LINES = "LINESTRING (x y, …) or MULTILINESTRING ((x y, …), …), also Z, M or ZM, with two or more points"


def streets(path: Path, text: str) -> Streets:
    """Streets of a graph whose nodes have the data x and y (m; degrees if the graph's `crs` says so), or longitude and
    latitude (degrees). An edge is straight, or follows its `geometry`, whatever the direction of that is."""
    found = xml.elements(path, text)
    graph = next((element for element in found if element.name == "graph"), None)
    if graph is None:
        raise bad_content(path, "no <graph>", "GraphML")
    # Data refer to keys, which have names.
    names = {
        element.attributes["id"]: element.attributes["attr.name"]
        for element in found
        if element.name == "key" and {"id", "attr.name"} <= element.attributes.keys()
    }

    def data(element: xml.Element, name: str) -> str | None:
        for child in element.named("data"):
            key = child.attributes.get("key", "")
            if names.get(key, key) == name:
                return child.text
        return None

    is_geographic = any(map(_is_geographic, (graph.text, *(child.text for child in graph.children))))
    places: dict[str, Point] = {}
    in_degrees = False
    for node in found:
        if node.name != "node":
            continue
        at = None
        for x_name, y_name, degrees in _COORDINATES:
            x, y = (xml.number((data(node, name) or "").strip()) for name in (x_name, y_name))
            if x is not None and y is not None:
                at = (x, y)
                in_degrees |= degrees or is_geographic
                break
        if at is None or "id" not in node.attributes:
            raise bad_line(path, node.line, "<node>", "an id and the data x and y, or longitude and latitude")
        if in_degrees and not (abs(at[0]) <= 180.0 and abs(at[1]) <= 89.0):
            raise bad_line(path, node.line, str(list(at)), "degrees")
        places[node.attributes["id"]] = at
    made = Streets()
    for edge in found:
        if edge.name != "edge":
            continue
        start, end = (places.get(edge.attributes.get(key, "")) for key in ("source", "target"))
        if start is None or end is None:
            raise bad_line(path, edge.line, "<edge>", "source and target, two nodes")
        geometry = data(edge, "geometry")
        if geometry is None:
            made.add([start, end])
            continue
        lines = _lines(geometry)
        if not lines:
            raise bad_line(path, edge.line, geometry, _LINES)
        made.add_edge(start, end, lines)
    if in_degrees:
        made.to_plane()
    else:
        made.to_origin()
    return made


def _is_geographic(crs: str) -> bool:
    """True if this value of the graph's `crs` means degrees: ``epsg:4326``, in older files of OSMnx
    ``{'init': 'epsg:4326'}``."""
    return "epsg:4326" in crs.lower() or crs.strip() == "WGS84"


def _lines(text: str) -> list[list[Point]] | None:
    """Lines of a ``LINESTRING`` or the parts of a ``MULTILINESTRING``, without heights and measures; None if the text is
    anything else."""
    words = re.sub(r"([(),])", r" \1 ", text.upper()).split()
    if len(words) < 2:
        return None
    # A space before the dimension is optional.
    kind = words[0].rstrip("ZM")
    rest = iter(words[2:] if words[1] in ("Z", "M", "ZM") else words[1:])
    try:
        if kind == "LINESTRING":
            lines = [_line(next(rest), rest)]
        elif kind == "MULTILINESTRING":
            lines = []
            mark = next(rest)
            # EMPTY has no mark.
            while mark == "," or (mark == "(" and not lines):
                lines.append(_line(next(rest), rest))
                mark = next(rest)
            if mark != ")":
                return None
        else:
            return None
    except (StopIteration, ValueError):
        return None
    return None if next(rest, None) is not None else [line for line in lines if line]


def _line(first: str, words: Iterator[str]) -> list[Point]:
    """Points of ``(x y, …)``, two or more, or none of ``EMPTY``; the first word is given."""
    points: list[Point] = []
    mark = first
    while mark == "," or (mark == "(" and not points):
        numbers: list[float] = []
        while True:
            mark = next(words)
            value = xml.number(mark)
            if value is None or not math.isfinite(value):
                break
            numbers.append(value)
        if not 2 <= len(numbers) <= 4:
            raise ValueError
        points.append((numbers[0], numbers[1]))
    if (mark == ")" and len(points) > 1) or (mark == "EMPTY" and not points):
        return points
    raise ValueError
