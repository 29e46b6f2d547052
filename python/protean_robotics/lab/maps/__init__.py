"""Scenarios from published files: maps of ROS, the grid maps and problems of MovingAI, street graphs and patrol graphs.

``protean new FILE --from MAP`` writes what :func:`scenario` makes: a vector map, and the text of a scenario that uses it and
passes the check. Only the largest connected part of the free space remains free, so that every robot can reach every other
one.
"""

import argparse
import json
import sys
from pathlib import Path

from ..._errors import Error
from . import movingai, patrol, scenarios, streets
from .files import InvalidMap, extension, text
from .scenarios import Imported
from .world import World, of_cells, of_ros

__all__ = ["Imported", "main", "scenario"]

#: Extensions of the files that can be imported.
EXTENSIONS = ".yaml, .yml, .map, .scen, .graph, .graphml, .osm or .xml"
#: Side of a cell of a MovingAI map and width of a street (m).
CELL, STREET = 1.0, 8.0


def scenario(path: Path, *, cell: float = CELL, street: float = STREET, allow_outside: bool = False) -> Imported:
    """Scenario and map of a file.

    A map of ROS (``.yaml``) and of MovingAI (``.map``) become a chase, ``.scen`` robots with goals on its map, which lies
    beside it; ``.graph`` (``patrolling_sim``) a patrol on the map of ROS beside it; ``.graphml``, ``.osm`` and ``.xml`` (OpenStreetMap) become a chase in the streets. A chase has fewer robots
    at smaller distances where space is short.

    Parameters
    ----------
    path
        The file.
    cell
        Side of a cell of a MovingAI map (m), above 0.
    street
        Width of a street (m), above 0.
    allow_outside
        True if the file may refer to files outside its folder.

    Raises
    ------
    InvalidInput
        The text names the file, the line, the value and the expected one.
    """
    if extension(path) == "scen":
        return movingai.scenario(path, cell, allow_outside)
    if extension(path) == "graph":
        return patrol.scenario(path, allow_outside)
    return scenarios.chase(path, *read(path, cell=cell, street=street, allow_outside=allow_outside))


def read(
    path: Path, *, cell: float = CELL, street: float = STREET, allow_outside: bool = False
) -> tuple[World, float]:
    """World of a file without problems, and the length from which the sizes of robots follow (m)."""
    kind = extension(path)
    if kind in ("yaml", "yml"):
        return of_ros(path, allow_outside)
    if kind == "map":
        return of_cells(path, movingai.cells(path, text(path)), cell), cell
    if kind in streets.READERS:
        return streets.world(path, streets.READERS[kind](path, text(path)), street), 0.5 * street
    raise InvalidMap(f"{path}: unknown kind of file: expected {EXTENSIONS}")


def main(arguments: list[str]) -> int:
    """Prints a scenario, the path of its map and the map as JSON, for ``protean new``."""
    parser = argparse.ArgumentParser(prog="protean new", allow_abbrev=False)
    parser.add_argument("file", type=Path)
    parser.add_argument("--cell", type=float, default=CELL)
    parser.add_argument("--street", type=float, default=STREET)
    parser.add_argument("--allow-outside", action="store_true")
    options = parser.parse_args(arguments)
    try:
        made = scenario(
            options.file, cell=options.cell, street=options.street, allow_outside=options.allow_outside
        )
    except (Error, ImportError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1 if isinstance(error, ImportError) else 2
    print(json.dumps(made))
    return 0
