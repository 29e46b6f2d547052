"""Extracts of OpenStreetMap in XML (``.osm``), also from JOSM and as answers of the Overpass API."""

from pathlib import Path

from . import xml
from .files import bad_content, bad_line
from .plane import Streets
from .world import Point

#: Values of `highway` that are no street.
_NO_STREETS = ("no", "platform")
#: Values of `highway`, and keys with the value `yes`, of streets that do not exist yet or no longer.
_NOT_IN_USE = (
    "abandoned",
    "construction",
    "demolished",
    "destroyed",
    "dismantled",
    "disused",
    "planned",
    "proposed",
    "razed",
    "removed",
)


def streets(path: Path, text: str) -> Streets:
    """Streets of an extract: its ways with the tag `highway` that exist. The places of a way are those of its nodes, or its
    own (``out geom`` of the Overpass API). Parts of ways outside the extract are left out."""
    root = xml.elements(path, text)[0]
    if root.name != "osm":
        raise bad_content(path, f"an element <{root.name}>", "<osm>")
    # A deleted node has no place.
    places: dict[str, Point | None] = {}
    for node in root.named("node"):
        is_deleted = _is_deleted(node)
        at = None if is_deleted else _place(node)
        if "id" not in node.attributes or (at is None and not is_deleted):
            raise bad_line(path, node.line, "<node>", "id, lat and lon (degrees)")
        places[node.attributes["id"]] = at
    made = Streets()
    ways = 0
    for way in root.named("way"):
        if _is_deleted(way) or not _is_street(way):
            continue
        ways += 1
        last: Point | None = None
        for end in way.named("nd"):
            name = end.attributes.get("ref", "")
            at = None
            if "lat" in end.attributes:
                at = _place(end)
                if at is None:
                    raise bad_line(path, end.line, "<nd>", "lat and lon (degrees)")
            elif name in places:
                at = places[name]
                if at is None:
                    raise bad_line(path, end.line, f"deleted node {name}", "a node of the way")
            if last is not None and at is not None:
                made.add([last, at])
            last = at
    if ways and not made.pieces:
        expected = "nodes with lat and lon, or lat and lon in the ways (`out geom`)"
        raise bad_content(path, f"no places of the nodes of {ways} streets", expected)
    made.to_plane()
    return made


def _place(element: xml.Element) -> Point | None:
    """Longitude and latitude (degrees); None if they are absent or invalid."""
    lon, lat = (xml.number(element.attributes.get(key)) for key in ("lon", "lat"))
    if lon is None or lat is None or not (abs(lon) <= 180.0 and abs(lat) <= 89.0):
        return None
    return lon, lat


def _is_deleted(element: xml.Element) -> bool:
    """True if the object is deleted: in the editor JOSM, or in the database."""
    return element.attributes.get("action") == "delete" or element.attributes.get("visible") == "false"


def _is_street(way: xml.Element) -> bool:
    tags: dict[str, str | None] = {}
    for tag in way.named("tag"):
        tags.setdefault(tag.attributes.get("k", ""), tag.attributes.get("v"))
    kind = tags.get("highway")
    return (
        kind is not None
        and kind not in (*_NO_STREETS, *_NOT_IN_USE)
        and not any(tags.get(key) == "yes" for key in (*_NOT_IN_USE, "area"))
    )
