"""First guesses: a way over a grid by A*, pulled tight, sampled evenly."""

import heapq
import math

import numpy as np

CELLS_PX = (8.0, 4.0, 2.0)
SQRT2 = math.sqrt(2.0)


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


def states(instance, path, intervals):
    """States x, y, theta, v, w at the nodes and a time, for a path given as a polyline."""
    points = resample(path, intervals + 1)
    length = float(np.sum(np.hypot(*np.diff(path, axis=0).T)))
    time = max(length, 1e-3) / instance.v_max
    steps = np.diff(points, axis=0)
    direction = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    theta = np.concatenate([direction[:1], 0.5 * (direction[1:] + direction[:-1]), direction[-1:]])
    theta += 2.0 * math.pi * round((instance.start_theta - theta[0]) / (2.0 * math.pi))
    theta[0] = instance.start_theta
    speed = np.full(intervals + 1, instance.v_max)
    if instance.has_dynamics:
        # Turns take time: smooth headings, lower speed, extra time at the ends.
        for _ in range(3):
            theta[1:-1] = (theta[:-2] + theta[1:-1] + theta[2:]) / 3.0
        speed *= 0.9
        time = 1.1 * time + 1.0
    turn_rate = np.gradient(theta) * intervals / time
    turn_rate = np.clip(turn_rate, -0.9 * instance.w_max, 0.9 * instance.w_max)
    return np.column_stack([points, theta, speed, turn_rate]), time


def turned_other_way(instance, guess):
    """The same guess with the last turn, if it is a long one, in the opposite direction; else `None`."""
    if instance.goal_theta is None:
        return None
    last = (instance.goal_theta - guess[-1, 2] + math.pi) % (2.0 * math.pi) - math.pi
    if abs(last) < 2.0:
        return None
    other = guess.copy()
    other[-1, 2] += last - math.copysign(2.0 * math.pi, last)
    return other


def from_samples(instance, samples, intervals):
    """The same of a plan's samples [[t, x, y, theta, v, omega], ...]."""
    samples = np.asarray(samples, dtype=float)
    time = samples[-1, 0] - samples[0, 0]
    where = samples[0, 0] + np.linspace(0.0, time, intervals + 1)
    columns = samples[:, 1:6].copy()
    columns[:, 2] = np.unwrap(columns[:, 2])
    columns[:, 2] += 2.0 * math.pi * round((instance.start_theta - columns[0, 2]) / (2.0 * math.pi))
    return np.column_stack([np.interp(where, samples[:, 0], column) for column in columns.T]), time
