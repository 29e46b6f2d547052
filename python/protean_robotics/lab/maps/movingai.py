"""The benchmark files of MovingAI: octile maps and the problems on them.

Format: N. Sturtevant, *Benchmarks for Grid-Based Pathfinding*, 2012, and movingai.com/benchmarks/formats.html.
"""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .files import bad_content, bad_line, lines, stem, text, text_beside
from .scenarios import Imported, passing, problems_text, robot_text
from .world import number, of_cells

#: Maximum number of cells.
_MAX_CELLS = 25_000_000
#: Maximum number of robots.
_MAX_ROBOTS = 4
#: Fields of a problem.
_FORM = "bucket, map, width, height, start x, start y, goal x, goal y, length"

Cell = tuple[int, int]


def cells(path: Path, text: str) -> NDArray[np.bool_]:
    """Cells of a map (``.map``), true for obstacles, the first row of the result the one with the smallest y.

    Passable are ground (``.``, ``G``) and swamp (``S``); trees (``T``), water (``W``) and what is out of bounds (``@``,
    ``O``) are obstacles.
    """
    found = lines(text)

    def header(index: int, key: str, expected: str) -> str:
        line = found[index] if index < len(found) else ""
        if not line.strip().startswith(key):
            raise bad_line(path, min(index, len(found)) + 1, line, expected)
        return line.strip().removeprefix(key).strip()

    def size(index: int, key: str) -> int:
        expected = f"{key} and a number of cells > 0"
        value = header(index, key, expected)
        count = _count(value)
        if not count:
            raise bad_line(path, index + 1, value, expected)
        return count

    header(0, "type", "type octile")
    height, width = size(1, "height"), size(2, "width")
    header(3, "map", "map")
    if width * height > _MAX_CELLS:
        raise bad_content(path, f"{width} × {height} cells", f"at most {_MAX_CELLS} cells")
    rows = [line.rstrip() for line in found[4 : 4 + height]]
    for index, row in enumerate(rows):
        if len(row) != width or row.strip(".GSTW@O"):
            raise bad_line(path, 5 + index, found[4 + index], f"{width} of the characters . G S T W @ O")
    if len(rows) != height:
        raise bad_content(path, f"{len(rows)} rows of cells", f"{height} rows")
    marks = np.frombuffer("".join(reversed(rows)).encode(), dtype=np.uint8)
    return np.isin(marks, np.frombuffer(b"TW@O", dtype=np.uint8)).reshape(height, width)


class Problems(NamedTuple):
    """The problems of a ``.scen`` file: path of the map as written, its columns and rows, and start and goal of each
    problem: column and row, counted from the *top* left."""

    map: str
    size: Cell
    tasks: list[tuple[Cell, Cell]]


def problems(path: Path, text: str) -> Problems:
    """Problems (``.scen``, version 1), all on one map."""
    version, *rest = lines(text) or [""]
    if not version.strip().startswith("version 1"):
        raise bad_line(path, 1, version, "version 1")
    found: Problems | None = None
    for index, line in enumerate(rest):
        if not line.strip():
            continue
        # Names of maps contain spaces; tabs separate the fields then.
        fields = [field.strip() for field in line.split("\t")] if "\t" in line else line.split()
        numbers = [_count(field) for field in fields[2:8]]
        if len(fields) != 9 or None in numbers:
            raise bad_line(path, index + 2, line, _FORM)
        width, height, *ends = (number or 0 for number in numbers)
        start, goal = (ends[0], ends[1]), (ends[2], ends[3])
        if any(column >= width or row >= height for column, row in (start, goal)):
            raise bad_line(path, index + 2, line, "positions on the map")
        if found is None:
            found = Problems(fields[1], (width, height), [])
        if found[:2] != (fields[1], (width, height)):
            raise bad_line(path, index + 2, line, "the map of the lines before")
        found.tasks.append((start, goal))
    if found is None:
        raise bad_content(path, "no problem", "at least one")
    return found


def _count(text: str) -> int | None:
    return int(text) if re.fullmatch(r"\+?[0-9]{1,19}", text) else None


def scenario(path: Path, cell: float, allow_outside: bool) -> Imported:
    """Robots with the starts and goals of the first problems of a file that do not share a cell, on its map with cells of
    this side (m)."""
    found = problems(path, text(path))
    # The map's name if a file of this name is beside the problems, else its path as written.
    name = Path(found.map).name
    other = name if name and (path.parent / name).exists() else found.map
    map_file = path.parent / other
    world = of_cells(map_file, cells(map_file, text_beside(path, other, allow_outside)), cell)
    height, width = world.cells.occupied.shape
    if found.size != (width, height):
        size = f"problems on {found.size[0]} × {found.size[1]} cells"
        raise bad_content(path, size, f"the {width} × {height} cells of the map")

    def is_free(at: Cell) -> bool:
        # Rows of problems are counted from the top.
        return not world.cells.occupied[height - 1 - at[1], at[0]]

    starts: set[Cell] = set()
    goals: set[Cell] = set()
    robots = []
    for start, goal in found.tasks:
        if len(starts) == _MAX_ROBOTS:
            break
        if start == goal or start in starts or goal in goals or not (is_free(start) and is_free(goal)):
            continue
        starts.add(start)
        goals.add(goal)
        (x0, y0), (x1, y1) = (world.cells.center(at[0], height - 1 - at[1]) for at in (start, goal))
        robots.append(
            f'[[robots]]\nname = "robot_{len(starts)}"\nteam = "neutral"\n'
            f"start = {{ x = {number(x0)}, y = {number(y0)}, theta = 0.0 }}"
            f"  # cell {list(start)} of the map's file\n"
            f"goal.circle = {{ center = [{number(x1)}, {number(y1)}], radius = {number(0.25 * cell)} }}"
            f"  # cell {list(goal)}\n\n"
        )
    if not robots:
        raise bad_content(
            path, "no problem between different cells of the largest connected free part", "at least one"
        )
    map_stem = stem(map_file)
    made = problems_text(stem(path), map_stem, world, robot_text(cell), "".join(robots))
    return passing(path, world, map_stem, [made], "one of the first problems")
