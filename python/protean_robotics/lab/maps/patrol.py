"""Patrol graphs of ``patrolling_sim`` (``.graph``), with the map of ROS beside them."""

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .files import bad_content, stem, text
from .scenarios import Imported, passing, patrol_text
from .world import Cells, Point, World, number, of_grid, of_ros

#: Numbers of a header without and with an offset (m), before the vertices.
_HEADERS = (6, 4)
#: Radii of robots that are tried (m).
_RADII = (0.25, 0.2, 0.15, 0.1, 0.05)


class Graph(NamedTuple):
    """A patrol graph.

    Attributes
    ----------
    size
        Columns and rows of its map.
    side
        Side of a cell (m).
    origin
        Lower left corner of its map (m).
    nodes
        Positions (m).
    edges
        Pairs of nodes, the smaller one first, with their lengths (m).
    """

    size: tuple[int, int]
    side: float
    origin: Point
    nodes: list[Point]
    edges: dict[tuple[int, int], float]


def graph(path: Path, text: str) -> Graph:
    """Graph of a text: number of vertices, width and height (cells), side of a cell (m) and, in newer files, an offset
    (m); for each vertex its number, column, row and number of neighbours, and for each neighbour its number, direction and
    cost (cells)."""
    words = text.split()
    for header in _HEADERS:
        found = _graph(words, header)
        if found is not None:
            return found
    raise bad_content(path, "no patrol graph", "the vertices of `patrolling_sim`, each with its neighbours")


def _graph(words: list[str], header: int) -> Graph | None:
    """Graph of the words of a file with this many numbers in its header; ``None`` if they are no such graph."""
    rest = iter(words)
    try:
        count, columns, rows, side = int(next(rest)), int(next(rest)), int(next(rest)), float(next(rest))
        offset = (float(next(rest)), float(next(rest))) if header == _HEADERS[0] else (0.0, 0.0)
        nodes: list[Point] = []
        edges: dict[tuple[int, int], float] = {}
        for vertex in range(count):
            if int(next(rest)) != vertex:
                return None
            column, row, neighbours = float(next(rest)), float(next(rest)), int(next(rest))
            nodes.append((offset[0] + column * side, offset[1] + row * side))
            for _ in range(neighbours):
                to, _direction, cost = int(next(rest)), next(rest), float(next(rest))
                if not (0 <= to < count and to != vertex and cost > 0.0):
                    return None
                edges.setdefault((min(vertex, to), max(vertex, to)), cost * side)
    except (StopIteration, ValueError):
        return None
    values = [side, *offset, *(value for node in nodes for value in node), *edges.values()]
    is_sound = side > 0.0 and columns > 0 and rows > 0 and all(map(math.isfinite, values))
    return Graph((columns, rows), side, offset, nodes, edges) if is_sound and next(rest, None) is None else None


def scenario(path: Path, allow_outside: bool) -> Imported:
    """Four robots, or one, that patrol a graph on the map of ROS with its name, or without obstacles if there is none."""
    found = graph(path, text(path))
    beside = path.with_suffix(".yaml")
    world = of_ros(beside, allow_outside)[0] if beside.is_file() else _empty(path, found)
    name = stem(path)
    nodes = "".join(f"    [{number(x)}, {number(y)}],\n" for x, y in found.nodes)
    edges = "".join(f"    [{a}, {b}],\n" for a, b in found.edges)
    lengths = "".join(f"    {number(length)},\n" for length in found.edges.values())
    tables = f"nodes = [\n{nodes}]  # [m]\nedges = [\n{edges}]\nlengths = [\n{lengths}]  # [m]\n"
    texts = (patrol_text(name, world, robots, radius, tables) for robots in (4, 1) for radius in _RADII)
    return passing(path, world, name, texts, f"one robot of radius {_RADII[-1]} m")


def _empty(path: Path, found: Graph) -> World:
    columns, rows = found.size
    free = np.zeros((rows, columns), dtype=np.bool_)
    return of_grid(path, Cells(free, found.side, found.origin), found.side)
