"""Streets as free corridors between blocks."""

import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import graphml, osm
from .files import bad_content
from .plane import Streets, extent
from .world import Cells, Point, World, of_grid

#: Readers of the streets of a file by its extension.
READERS = {"graphml": graphml.streets, "osm": osm.streets, "xml": osm.streets}
#: Maximum number of cells.
_MAX_CELLS = 4e6
#: Number of cells across a street, if the world is not too large for it.
_ACROSS = 8.0
#: Minimum number of cells across a street.
_MIN_ACROSS = 3.0


def world(path: Path, streets: Streets, width: float) -> World:
    """World in which the streets with this width (m) are free and all else is occupied."""
    ends = [end for piece in streets.pieces for end in piece]
    if not ends:
        raise bad_content(path, "no street", "at least one")
    if not all(map(math.isfinite, (c for end in ends for c in end))):
        raise bad_content(path, "a place at infinity", "numbers")
    (left, bottom), (right, top) = extent(ends)
    longest = max(right - left, top - bottom)
    if longest < width:
        expected = f"metres, or the `crs` of degrees, and more than {width:g} m"
        raise bad_content(path, f"streets within {longest:.3f} m × {longest:.3f} m", expected)
    border = 0.5 * width
    w, h = right - left + 2.0 * border, top - bottom + 2.0 * border
    side = max(width / _ACROSS, math.sqrt(w * h / _MAX_CELLS))
    if side * _MIN_ACROSS > width:
        found = f"streets on {w / 1e3:.1f} km × {h / 1e3:.1f} km"
        raise bad_content(path, found, f"a smaller part, or streets wider than {width:g} m")
    shape = (math.ceil(h / side), math.ceil(w / side))
    cells = Cells(np.ones(shape, dtype=bool), side, (left - border, bottom - border))
    columns = cells.origin[0] + (np.arange(shape[1]) + 0.5) * side
    for piece in streets.pieces:
        # Rounding must not tell a street from its reverse.
        start, end = sorted(piece)
        _clear(cells, columns, start, end, border)
    return of_grid(path, cells, side)


def _clear(cells: Cells, columns: NDArray[np.floating[Any]], start: Point, end: Point, reach: float) -> None:
    """Frees the cells whose centres are at most this far from a segment (m)."""
    (x0, y0), (x1, y1) = start, end
    ax, ay = x1 - x0, y1 - y0
    squared = ax * ax + ay * ay

    def index(value: float, count: int) -> int:
        return int(min(max(value / cells.side, 0.0), count - 1.0))

    height, width = cells.occupied.shape
    (left, bottom) = cells.origin
    first = index(min(y0, y1) - reach - bottom, height)
    last = index(max(y0, y1) + reach - bottom, height)
    for row in range(first, last + 1):
        y = bottom + (row + 0.5) * cells.side
        # The part of the segment that is not too far below or above the row.
        ends = [x0, x1]
        if ay != 0.0:
            part = [(y - reach - y0) / ay, (y + reach - y0) / ay]
            if all(map(math.isfinite, part)):
                ends = [x0 + min(max(share, 0.0), 1.0) * ax for share in part]
        low = index(min(ends) - reach - left, width)
        high = index(max(ends) + reach - left, width)
        x = columns[low : high + 1]
        share = np.clip(((x - x0) * ax + (y - y0) * ay) / squared, 0.0, 1.0) if squared > 0.0 else 0.0
        dx, dy = x0 + share * ax - x, y0 + share * ay - y
        cells.occupied[row, low : high + 1] &= np.sqrt(dx * dx + dy * dy) > reach
