"""Worlds of rectangles, from the cells of a grid."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..._core import lab
from ..._errors import InvalidInput
from ..._optional import imported
from .files import InvalidMap, bad_content

#: Maximum number of cells of a grid computed from the vector map, if the file's own cells are fewer.
_MAX_CELLS = 4_000_000
#: Maximum number of cells computed per side of a cell of the file.
_MAX_FACTOR = 4
#: Maximum size of a world (m) and number of its obstacles.
_MAX_SIZE, _MAX_OBSTACLES = 1e5, 1 << 16
#: Length from which the sizes of robots follow on a map of ROS (m), unless a pixel is larger or the map is small.
_LENGTH = 0.5
#: Minimum ratio of the shorter side of a map of ROS to that length, unless a pixel is larger.
_MIN_LENGTHS = 10.0

Point = tuple[float, float]


class Cells(NamedTuple):
    """Cells of a grid.

    Attributes
    ----------
    occupied
        True for obstacles, shape (rows, columns); rows along +y.
    side
        Side of a cell (m).
    origin
        Outer corner of cell (0, 0) (m).
    """

    occupied: NDArray[np.bool_]
    side: float
    origin: Point

    def center(self, column: int, row: int) -> Point:
        """Centre of a cell (m)."""
        return self.origin[0] + (column + 0.5) * self.side, self.origin[1] + (row + 0.5) * self.side

    def corner(self, column: int, row: int) -> Point:
        """Lower left corner of a cell (m)."""
        return self.origin[0] + column * self.side, self.origin[1] + row * self.side


class World(NamedTuple):
    """A world.

    Attributes
    ----------
    cells
        Its cells; unreachable free ones are occupied.
    resolution
        Side of the cells of grids computed from the map (m).
    rectangles
        Lower left and upper right corners of the obstacles (m).
    """

    cells: Cells
    resolution: float
    rectangles: list[tuple[Point, Point]]

    def free_area(self) -> float:
        """Area of the free space (m²)."""
        return float((~self.cells.occupied).sum()) * self.cells.side**2

    def corners(self) -> tuple[Point, Point]:
        """Smallest and largest corner (m)."""
        rows, columns = self.cells.occupied.shape
        (x, y), side = self.cells.origin, self.cells.side
        return (x, y), (x + columns * side, y + rows * side)

    def place_in_corner(self, clearance: float) -> Point | None:
        """Place (m) that is nearest to the smallest corner among the centres of free cells from which no occupied cell is
        nearer than this (m), if there is one."""
        # From a centre, its own cell reaches half a cell.
        around = int(max(np.ceil(clearance / self.cells.side - 0.5), 0.0))
        rows, columns = self.cells.occupied.shape
        span = 2 * around + 1
        if rows < span or columns < span:
            return None
        sums = np.zeros((rows + 1, columns + 1), dtype=np.int64)
        sums[1:, 1:] = self.cells.occupied.cumsum(axis=0, dtype=np.int64).cumsum(axis=1)
        blocked = sums[span:, span:] - sums[:-span, span:] - sums[span:, :-span] + sums[:-span, :-span]
        row, column = np.nonzero(blocked == 0)
        if not row.size:
            return None
        row, column = row + around, column + around
        nearest = int((row * row + column * column).argmin())
        return self.cells.center(int(column[nearest]), int(row[nearest]))

    def toml(self, name: str) -> str:
        """The map as TOML."""
        (left, bottom), (right, top) = self.corners()
        parts = [
            f'name = "{name}"\nbounds = {{ min = [{number(left)}, {number(bottom)}], '
            f"max = [{number(right)}, {number(top)}] }}  # [m]\n"
            f"resolution = {number(self.resolution)}  # [m]\nobstacles = [\n"
        ]
        for (x0, y0), (x1, y1) in self.rectangles:
            center = f"[{number(_middle(x0, x1))}, {number(_middle(y0, y1))}]"
            half = f"[{number(0.5 * (x1 - x0))}, {number(0.5 * (y1 - y0))}]"
            parts.append(f"  {{ shape.rectangle = {{ center = {center}, half_extents = {half} }} }},\n")
        return "".join(parts) + "]\n"


def _middle(a: float, b: float) -> float:
    return (a + b) * 0.5


def number(value: float) -> str:
    """A number as TOML, the shortest text that is read as the same bits."""
    text = repr(float(value))
    mantissa, mark, exponent = text.partition("e")
    return f"{mantissa}e{int(exponent)}" if mark else text


def of_cells(path: Path, occupied: NDArray[np.bool_], side: float) -> World:
    """World of the cells of a file with this side (m), the first cell at the origin."""
    factors = range(_MAX_FACTOR, 0, -1)
    factor = next((factor for factor in factors if occupied.size * factor * factor <= _MAX_CELLS), 1)
    return of_grid(path, Cells(occupied, side, (0.0, 0.0)), side / factor)


def of_grid(path: Path, cells: Cells, resolution: float) -> World:
    """World of cells, with the side of the cells of computed grids (m)."""
    extent = max(cells.occupied.shape) * cells.side
    if not (cells.side > 0.0 and extent <= _MAX_SIZE):
        raise bad_content(path, f"a world of {number(extent)} m", f"a size > 0 and ≤ {_MAX_SIZE:g} m")
    occupied = _largest(cells.occupied)
    if occupied.all():
        raise bad_content(path, "no free cell", "free space")
    cells = cells._replace(occupied=occupied)
    return World(cells, resolution, _rectangles(path, cells))


def of_ros(path: Path, allow_outside: bool) -> tuple[World, float]:
    """World of a map of ROS, whose unknown cells are obstacles, and the length from which the sizes of robots follow (m)."""
    try:
        occupied, side, origin = lab.ros_map(path, allow_outside)
    except InvalidInput as error:
        raise InvalidMap(str(error)) from None
    shorter = min(occupied.shape) * side
    length = max(min(shorter / _MIN_LENGTHS, _LENGTH), side)
    return of_grid(path, Cells(occupied, side, tuple(origin)), side), length


def _largest(occupied: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Marks all free cells as occupied except those of the largest part that is connected over the sides of cells; of
    equal ones, that with the first cell."""
    part_of: NDArray[Any] = imported("scipy.ndimage").label(~occupied)[0]
    sizes = np.bincount(part_of.ravel())
    sizes[0] = 0
    if not sizes.any():
        return np.ones_like(occupied)
    first = int((sizes == sizes.max())[part_of.ravel()].argmax())
    largest: NDArray[np.bool_] = part_of != part_of.ravel()[first]
    return largest


def _rectangles(path: Path, cells: Cells) -> list[tuple[Point, Point]]:
    """Rectangles that cover the occupied cells: each takes the longest remaining run of a row and as many following rows
    as contain the whole run. Corners on the same border of cells have the same bits."""
    left = cells.occupied.copy()
    rows = left.shape[0]
    found = []
    for row in np.flatnonzero(left.any(axis=1)):
        steps = np.diff(left[row].astype(np.int8), prepend=0, append=0)
        for start, stop in zip(np.flatnonzero(steps == 1), np.flatnonzero(steps == -1), strict=True):
            end = int(row)
            while end < rows and left[end, start:stop].all():
                left[end, start:stop] = False
                end += 1
            found.append((cells.corner(int(start), int(row)), cells.corner(int(stop), end)))
        if len(found) > _MAX_OBSTACLES:
            expected = f"at most {_MAX_OBSTACLES}: a smaller part"
            raise bad_content(path, f"more than {_MAX_OBSTACLES} rectangles", expected)
    return found
