"""First guesses: ways over a grid by A*, pulled tight, driven leg by leg."""

import heapq
import math
from dataclasses import dataclass

import numpy as np

CELLS_PX = (8.0, 4.0, 2.0)
SQRT2 = math.sqrt(2.0)
# Corridors tried for guesses of several kinds.
CORRIDORS = 4


def grid_path(instance, avoid=()):
    """A polyline from start to goal, or `None`. Paths in `avoid` cost more, to find other corridors."""
    for cell in CELLS_PX:
        path = search(instance, cell, avoid)
        if path is not None:
            return pull_tight(instance, path)
    return None


def search(instance, cell, avoid):
    x0, y0, x1, y1 = instance.bounds
    columns = max(1, math.ceil((x1 - x0) / cell))
    rows = max(1, math.ceil((y1 - y0) / cell))
    xs = x0 + (np.arange(columns) + 0.5) * (x1 - x0) / columns
    ys = y0 + (np.arange(rows) + 0.5) * (y1 - y0) / rows
    # A ring of blocked cells saves the search all tests for the edge.
    free = np.zeros((rows + 2, columns + 2), dtype=bool)
    inner = np.ones((rows, columns), dtype=bool)
    for (cx, cy), radius in zip(instance.centres, instance.radii):
        inner &= (xs[None, :] - cx) ** 2 + (ys[:, None] - cy) ** 2 > radius * radius
    free[1:-1, 1:-1] = inner
    width = columns + 2

    def index(point):
        column = int(np.clip((point[0] - x0) / (x1 - x0) * columns, 0, columns - 1))
        row = int(np.clip((point[1] - y0) / (y1 - y0) * rows, 0, rows - 1))
        return (row + 1) * width + column + 1

    start, goal = index(instance.start), index(instance.goal)
    weights = np.ones((rows + 2, columns + 2))
    for path in avoid:
        points = resample(path, 200)
        ends = [np.asarray(instance.start), np.asarray(instance.goal)]
        far = np.min([np.hypot(*(points - end).T) for end in ends], axis=0) > 40.0
        for px, py in points[far]:
            near = (xs[None, :] - px) ** 2 + (ys[:, None] - py) ** 2 < 25.0**2
            weights[1:-1, 1:-1][near] = 2.0
    free = free.ravel()
    free[start] = free[goal] = True
    free = free.tolist()
    weights = weights.ravel().tolist()
    moves = [(1, 1.0), (-1, 1.0), (width, 1.0), (-width, 1.0)]
    moves += [(a + b, SQRT2) for a in (1, -1) for b in (width, -width)]
    goal_row, goal_column = divmod(goal, width)

    def to_go(node):
        row, column = divmod(node, width)
        dx, dy = abs(column - goal_column), abs(row - goal_row)
        return max(dx, dy) + (SQRT2 - 1.0) * min(dx, dy)

    cost = {start: 0.0}
    parent = {start: start}
    closed = set()
    queue = [(to_go(start), start)]
    while queue:
        _, node = heapq.heappop(queue)
        if node in closed:
            continue
        closed.add(node)
        if node == goal:
            break
        base = cost[node]
        for step, length in moves:
            other = node + step
            if not free[other] or other in closed:
                continue
            new = base + length * weights[other]
            if new < cost.get(other, math.inf):
                cost[other] = new
                parent[other] = node
                heapq.heappush(queue, (new + to_go(other), other))
    if goal not in closed:
        return None
    nodes = [goal]
    while nodes[-1] != start:
        nodes.append(parent[nodes[-1]])
    nodes.reverse()
    path = [(xs[node % width - 1], ys[node // width - 1]) for node in nodes]
    path[0], path[-1] = instance.start, instance.goal
    return np.array(path if len(path) > 1 else [instance.start, instance.goal])


def pull_tight(instance, path):
    """The path without the vertices that a straight line can skip."""
    kept, at = [0], 0
    while at < len(path) - 1:
        ahead = path[at + 1 :]
        seen = np.nonzero(sees(instance, path[at], ahead))[0]
        at += 1 + (int(seen[-1]) if len(seen) else 0)
        kept.append(at)
    return path[kept]


def sees(instance, origin, points):
    """For each point: `True` if the straight line to it is outside of all discs."""
    if len(instance.radii) == 0:
        return np.ones(len(points), dtype=bool)
    along = points - origin
    to_centre = instance.centres - origin
    length2 = np.maximum(np.sum(along**2, axis=1), 1e-12)
    share = np.clip(along @ to_centre.T / length2[:, None], 0.0, 1.0)
    gap = to_centre[None, :, :] - share[:, :, None] * along[:, None, :]
    return np.all(np.sum(gap**2, axis=2) >= (instance.radii * instance.radii)[None, :], axis=1)


def resample(path, count):
    """`count` points on the polyline, evenly spaced."""
    path = np.asarray(path, dtype=float)
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    where = np.linspace(0.0, lengths[-1], count)
    return np.column_stack([np.interp(where, lengths, path[:, i]) for i in (0, 1)])


@dataclass
class Guess:
    """Legs [(from, to, backwards)] with turns between them."""

    kind: str
    legs: list
    # Headings of the legs, not wrapped, and the last one.
    headings: list
    final: float
    # Time of turning and driving, at the greatest speeds.
    time: float

    def states(self, instance, intervals):
        """States x, y, theta, v, w at nodes evenly spaced along the legs, and a time."""
        lengths = [math.dist(a, b) for a, b, _ in self.legs]
        ends = np.concatenate([[0.0], np.cumsum(lengths)])
        where = np.linspace(0.0, ends[-1], intervals + 1)
        places = np.array([self.legs[0][0], *(b for _, b, _ in self.legs)])
        x, y = (np.interp(where, ends, places[:, i]) for i in (0, 1))
        leg = np.minimum(np.searchsorted(ends, where, side="right") - 1, len(lengths) - 1)
        theta = np.array(self.headings)[leg]
        theta[0], theta[-1] = instance.start_theta, self.final
        v = np.array([instance.v_min if backwards else instance.v_max for _, _, backwards in self.legs])[leg]
        time = float(np.sum(np.abs(np.diff(where) / v[:-1])))
        if instance.has_inertia:
            # Turns take time: smooth headings, lower speed, extra time at the ends.
            for _ in range(3):
                theta[1:-1] = (theta[:-2] + theta[1:-1] + theta[2:]) / 3.0
            v *= 0.9
            time = 1.1 * time + 1.0
        w = np.clip(np.gradient(theta) * intervals / time, -0.9 * instance.w_max, 0.9 * instance.w_max)
        return np.column_stack([x, y, theta, v, w]), time


def guesses(instance, count):
    """The `count` guesses that take the least time: through several corridors, with turns either way, and backwards."""
    paths, found = [], []
    while len(paths) < (1 if count == 1 else CORRIDORS):
        path = grid_path(instance, paths)
        if path is None:
            break
        paths.append(path)
        found += of_path(instance, path, len(paths))
    found.sort(key=lambda guess: guess.time)
    return found[:count]


def of_path(instance, path, corridor):
    """The guesses through one corridor."""
    ways = [("forwards", [(a, b, False) for a, b in zip(path[:-1], path[1:])])]
    if instance.v_min < 0.0:
        ways.append(("backwards", [(a, b, True) for a, b in zip(path[:-1], path[1:])]))
        # A leg along the given heading first, then the rest in the other direction.
        radius = instance.v_max / instance.w_max
        for sign in (1.0, -1.0):
            out = shifted(instance.start, instance.start_theta, sign * radius)
            if free(instance, path[0], out):
                rest = [(out, path[1]), *zip(path[1:-1], path[2:])]
                legs = [(path[0], out, sign < 0.0), *((a, b, sign > 0.0) for a, b in rest)]
                ways.append((f"{'forwards' if sign > 0.0 else 'backwards'} first", legs))
            if instance.goal_theta is None:
                continue
            out = shifted(instance.goal, instance.goal_theta, sign * radius)
            if free(instance, path[-1], out):
                rest = [*zip(path[:-2], path[1:-1]), (path[-2], out)]
                legs = [*((a, b, sign < 0.0) for a, b in rest), (out, path[-1], sign > 0.0)]
                ways.append((f"{'backwards' if sign > 0.0 else 'forwards'} at the end", legs))
    found = []
    for name, legs in ways:
        for first in (0, 1):
            for last in (0, 1) if instance.goal_theta is not None else (0,):
                kind = f"corridor {corridor}, {name}" + ", other turn first" * first + ", other turn last" * last
                found.append(driven(instance, legs, kind, first, last))
    return found


def driven(instance, legs, kind, first, last):
    """A guess; `first` and `last` take the long way round with the first and last turn."""
    headings, at, time = [], instance.start_theta, 0.0
    for leg, (a, b, backwards) in enumerate(legs):
        direction = math.atan2(b[1] - a[1], b[0] - a[0]) + (math.pi if backwards else 0.0)
        turn = turned(at, direction, first and leg == 0)
        at += turn
        headings.append(at)
        time += abs(turn) / instance.w_max
        time += math.dist(a, b) / abs(instance.v_min if backwards else instance.v_max)
    turn = 0.0 if instance.goal_theta is None else turned(at, instance.goal_theta, last)
    return Guess(kind, legs, headings, at + turn, time + abs(turn) / instance.w_max)


def turned(at, wanted, long_way):
    turn = (wanted - at + math.pi) % (2.0 * math.pi) - math.pi
    return turn - math.copysign(2.0 * math.pi, turn) if long_way else turn


def shifted(place, heading, length):
    return np.array(place) + length * np.array([math.cos(heading), math.sin(heading)])


def free(instance, origin, place):
    """Whether the straight line to a place is on the board and outside of all discs."""
    x0, y0, x1, y1 = instance.bounds
    on_board = x0 <= place[0] <= x1 and y0 <= place[1] <= y1
    return on_board and bool(sees(instance, np.asarray(origin), place[None, :])[0])
