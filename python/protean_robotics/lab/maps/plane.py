"""Streets in the plane."""

import math
from collections.abc import Callable, Sequence

from .world import Point

#: Mean radius of the Earth (m).
_EARTH = 6_371_008.8


class Streets:
    """A street graph in the plane: straight pieces of streets by their ends (m)."""

    def __init__(self) -> None:
        self.pieces: list[tuple[Point, Point]] = []

    def add(self, points: Sequence[Point]) -> None:
        """Adds the street along these points."""
        self.pieces.extend(zip(points, points[1:], strict=False))

    def add_edge(self, source: Point, target: Point, lines: Sequence[Sequence[Point]]) -> None:
        """Adds the street between two nodes along lines.

        The source is joined to the nearest end of a line, the target to the nearest of the other ends; directions and
        order of the lines are of no effect.
        """
        ends: list[Point] = []
        for line in lines:
            self.add(line)
            ends += [line[0], line[-1]]
        for node in (source, target):
            if ends:
                distances = [math.hypot(end[0] - node[0], end[1] - node[1]) for end in ends]
                nearest = distances.index(min(distances))
                self.add([node, ends[nearest]])
                ends[nearest] = ends[-1]
                ends.pop()

    def to_origin(self) -> None:
        """Moves the streets (m) so that their middle is the origin: worlds are small, projected coordinates large."""
        self._move(lambda at, middle: (at[0] - middle[0], at[1] - middle[1]))

    def to_plane(self) -> None:
        """Projects the streets (longitude, latitude; degrees) to the plane that touches the Earth at their middle (m), x
        east, y north. The error of distances is below 0.1 % within 50 km."""

        def projected(at: Point, middle: Point) -> Point:
            east, north = (math.radians(at[i] - middle[i]) * _EARTH for i in (0, 1))
            return east * math.cos(math.radians(middle[1])), north

        self._move(projected)

    def _move(self, moved: Callable[[Point, Point], Point]) -> None:
        if self.pieces:
            least, most = extent([end for piece in self.pieces for end in piece])
            middle = ((least[0] + most[0]) / 2, (least[1] + most[1]) / 2)
            self.pieces = [(moved(start, middle), moved(end, middle)) for start, end in self.pieces]


def extent(points: Sequence[Point]) -> tuple[Point, Point]:
    """Smallest and largest coordinates of one or more points."""
    xs, ys = zip(*points, strict=True)
    return (min(xs), min(ys)), (max(xs), max(ys))
