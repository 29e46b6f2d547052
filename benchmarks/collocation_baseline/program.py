"""Minimum time by direct collocation: one nonlinear program, stage by stage, for FATROP and for IPOPT."""

import functools
import math
import time as clock
from dataclasses import dataclass

import casadi as ca
import numpy as np

SOLVERS = ("fatrop", "ipopt")
# Lengths are in hundreds of pixels within the program, so that its variables are about 1.
UNIT = 100.0
# Nodes and weights on [0, 1].
GAUSS = [
    (0.5 - math.sqrt(0.15), 5.0 / 18.0),
    (0.5, 4.0 / 9.0),
    (0.5 + math.sqrt(0.15), 5.0 / 18.0),
]
# Weight that keeps an otherwise undetermined turn rate small.
CALM = 1e-6
MAX_ITER = 1000


@dataclass(frozen=True)
class Shape:
    """What the expressions of a program depend on; all values are parameters."""

    intervals: int
    discs: int
    # Speeds are linear within an interval (and states); otherwise constant (and controls).
    inertia: bool
    acceleration: bool
    angular_acceleration: bool
    wheels: bool
    # Which bounds of speed (least, greatest) and turn rate the wheels imply.
    implied: tuple
    # Given states: columns of `Solution.states` at the first and at the last node.
    first: tuple
    last: tuple

    @classmethod
    def of(cls, instance, intervals):
        speeds = lambda *values: tuple(i for i, value in enumerate(values, start=3) if value is not None)
        first = speeds(instance.start_speed, instance.start_turn_rate) if instance.has_inertia else ()
        last = speeds(instance.goal_speed) if instance.has_inertia else ()
        theta = () if instance.goal_theta is None else (2,)
        wheel, implied = instance.wheel_speed, (False, False, False)
        if wheel is not None:
            fastest_turn = 2.0 * wheel / instance.wheel_separation
            implied = (instance.v_min <= -wheel, instance.v_max >= wheel, instance.w_max >= fastest_turn)
        return cls(
            intervals=intervals,
            discs=len(instance.radii),
            inertia=instance.has_inertia,
            acceleration=instance.acceleration is not None,
            angular_acceleration=instance.angular_acceleration is not None,
            wheels=wheel is not None,
            implied=implied,
            first=(0, 1, 2, *first),
            last=(0, 1, *theta, *last),
        )


@dataclass
class Solution:
    """States x, y, theta, v, w at the nodes (pixels), the duration of an interval, and the effort.

    Without inertia, v and w of a node are those of the interval that it begins.
    """

    states: np.ndarray
    interval: float
    inertia: bool
    converged: bool
    status: str
    iterations: int
    solve_ms: float

    @property
    def time(self):
        return self.interval * (len(self.states) - 1)


class Rows:
    """Constraints in their order; FATROP has to be told which are equalities."""

    def __init__(self):
        self.rows, self.low, self.high, self.equal = [], [], [], []

    def add(self, expression, low, high):
        count = expression.numel()
        self.rows.append(expression)
        self.low += [low] * count
        self.high += [high] * count
        self.equal += [low == high] * count


def linear_speeds(state, control):
    """The next state where speed and turn rate change linearly within the interval."""
    x, y, theta, v, w, h = ca.vertsplit(state)
    dv, dw = ca.vertsplit(control)
    step_x = step_y = 0
    for s, weight in GAUSS:
        angle = theta + h * (s * w + 0.5 * s * s * dw)
        step_x += weight * (v + s * dv) * ca.cos(angle)
        step_y += weight * (v + s * dv) * ca.sin(angle)
    return ca.vertcat(x + h * step_x, y + h * step_y, theta + h * (w + 0.5 * dw), v + dv, w + dw, h)


def constant_speeds(state, control):
    """The next state where they are constant: an arc, exact but for 1e-8 of its length."""
    x, y, theta, h = ca.vertsplit(state)
    v, w = ca.vertsplit(control)
    half = 0.5 * h * w
    q = half * half
    chord = h * v * (1 - q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * (1 - q / 110)))))
    return ca.vertcat(x + chord * ca.cos(theta + half), y + chord * ca.sin(theta + half), theta + 2 * half, h)


@functools.cache
def program(solver, shape, barrier):
    """A `Program`, built once for all instances of a shape."""
    return Program(solver, shape, barrier)


class Program:
    """The program of all instances of one shape."""

    def __init__(self, solver, shape, barrier):
        begin = clock.process_time()
        self.solver, self.shape = solver, shape
        n, discs = shape.intervals, shape.discs
        given = [ca.SX.sym(f"given{node}", len(columns)) for node, columns in ((0, shape.first), (n, shape.last))]
        centres, squares = ca.SX.sym("c", discs, 2), ca.SX.sym("r2", discs)
        limits = ca.SX.sym("limits", 5)
        v_max, acceleration, angular_acceleration, half_axle, wheel_speed = ca.vertsplit(limits)
        rows, variables, cost = Rows(), [], 0
        state = ca.SX.sym("x0", 6 if shape.inertia else 4)
        for k in range(n + 1):
            variables.append(state)
            here, h = state, state[-1]
            if k < n:
                control, after = ca.SX.sym(f"u{k}", 2), ca.SX.sym(f"x{k + 1}", state.numel())
                variables.append(control)
                rows.add(after - (linear_speeds if shape.inertia else constant_speeds)(state, control), 0.0, 0.0)
                cost += CALM * control[1] ** 2 * (1 if shape.inertia else h)
                state = after
            if k in (0, n):
                columns = shape.last if k else shape.first
                rows.add(ca.vertcat(*[here[c] for c in columns]) - given[k // n], 0.0, 0.0)
            elif discs:
                # A chord between nodes of at most v_max h, both at sqrt(r^2 + chord^2 / 4) or more from
                # a centre, keeps r from it.
                away = (here[0] - centres[:, 0]) ** 2 + (here[1] - centres[:, 1]) ** 2
                rows.add(away - squares - (v_max * h) ** 2 / 4, 0.0, math.inf)
            if k < n and shape.acceleration:
                rows.add(control[0] - acceleration * h, -math.inf, 0.0)
                rows.add(control[0] + acceleration * h, 0.0, math.inf)
            if k < n and shape.angular_acceleration:
                rows.add(control[1] - angular_acceleration * h, -math.inf, 0.0)
                rows.add(control[1] + angular_acceleration * h, 0.0, math.inf)
            if shape.wheels and (k < n or shape.inertia):
                v, w = (here[3], here[4]) if shape.inertia else (control[0], control[1])
                for wheel in (v + half_axle * w, v - half_axle * w):
                    rows.add(wheel - wheel_speed, -math.inf, 0.0)
                    rows.add(wheel + wheel_speed, 0.0, math.inf)
        nlp = {
            "x": ca.vertcat(*variables),
            "f": cost + n * state[-1],
            "g": ca.vertcat(*rows.rows),
            "p": ca.vertcat(ca.vec(centres), squares, limits, *given),
        }
        self._bounds = {"lbg": rows.low, "ubg": rows.high}
        self._solve = ca.nlpsol("minimum_time", solver, nlp, settings(solver, barrier, rows.equal))
        self.build_ms = 1e3 * (clock.process_time() - begin)

    def solve(self, instance, guess, time, grown=None):
        """Solve from states and a time. `grown` adds to the discs' radii, in pixels."""
        begin = clock.process_time()
        shape, n = self.shape, self.shape.intervals
        states = np.array(guess, dtype=float)
        states[:, [0, 1, 3]] /= UNIT
        lengths = lambda *values: [0.0 if value is None else value / UNIT for value in values]
        goal_theta = instance.goal_theta
        if goal_theta is not None:
            goal_theta += 2.0 * math.pi * round((states[n, 2] - goal_theta) / (2.0 * math.pi))
        ends = (
            (*lengths(*instance.start), instance.start_theta, *lengths(instance.start_speed), instance.start_turn_rate),
            (*lengths(*instance.goal), goal_theta, *lengths(instance.goal_speed)),
        )
        for node, columns, values in ((0, shape.first, ends[0]), (n, shape.last, ends[1])):
            for column in columns:
                states[node, column] = values[column]
        parameters = np.concatenate([
            (instance.centres / UNIT).T.ravel(),
            ((instance.radii + (0.0 if grown is None else grown)) / UNIT) ** 2,
            lengths(instance.v_max, instance.acceleration),
            [instance.angular_acceleration or 0.0],
            lengths(0.5 * (instance.wheel_separation or 0.0), instance.wheel_speed),
            states[0, list(shape.first)],
            states[n, list(shape.last)],
        ])
        shortest = max(math.dist(instance.start, instance.goal) / instance.v_max, 1e-2) / n
        x0, y0, x1, y1 = (edge / UNIT for edge in instance.bounds)
        speeds = (*lengths(instance.v_min, instance.v_max), instance.w_max)
        # FATROP slows down where a bound is stated twice, and needs room between bounds: those that
        # the wheels imply are left out, the interval is bound at the first node only, and given
        # states are equalities.
        least, most, turn = (
            free if implied else bound
            for free, implied, bound in zip((-math.inf, math.inf, math.inf), shape.implied, speeds)
        )
        low = self._in_order([x0, y0, -math.inf], [least, -turn], shortest)
        high = self._in_order([x1, y1, math.inf], [most, turn], 50.0 * shortest)
        for bound, free in ((low, -math.inf), (high, math.inf)):
            bound[1:, 5 if shape.inertia else 3] = free
            for node, columns in ((0, shape.first), (n, shape.last)):
                bound[node, list(columns)] = free
        interval = np.full((n + 1, 1), time / n)
        if shape.inertia:
            change = np.vstack([np.diff(states[:, 3:5], axis=0), [0.0, 0.0]])
            first = np.hstack([states, interval, change])
        else:
            middle = np.vstack([0.5 * (states[1:, 3:5] + states[:-1, 3:5]), [0.0, 0.0]])
            first = np.hstack([states[:, :3], interval, middle])
        flat = lambda table: table.ravel()[:-2]  # the last node has no controls
        result = self._solve(x0=flat(first), lbx=flat(low), ubx=flat(high), p=parameters, **self._bounds)
        stats = self._solve.stats()
        table = np.append(np.asarray(result["x"]).ravel(), [0.0, 0.0]).reshape(n + 1, -1)
        nodes = table[:, :5].copy()
        if not shape.inertia:
            nodes[:, 3:5] = table[:, 4:6]
            nodes[n, 3:5] = nodes[n - 1, 3:5]
        nodes[:, [0, 1, 3]] *= UNIT
        return Solution(
            states=nodes,
            interval=float(table[0, 5 if shape.inertia else 3]),
            inertia=shape.inertia,
            converged=bool(stats["success"]),
            status=str(stats.get("unified_return_status") if self.solver == "fatrop" else stats["return_status"]),
            iterations=int(stats["iter_count"]),
            solve_ms=1e3 * (clock.process_time() - begin),
        )

    def _in_order(self, pose, speeds, interval):
        """A row of values, repeated for all nodes, in the order of the variables."""
        free = [math.copysign(math.inf, pose[2])] * 2
        row = [*pose, *speeds, interval, *free] if self.shape.inertia else [*pose, interval, *speeds]
        return np.tile(np.array(row, dtype=float), (self.shape.intervals + 1, 1))


def settings(solver, barrier, equal):
    """Options of the solver: the same tolerance and initial barrier, one thread, no output."""
    common = {"print_time": False, "error_on_fail": False}
    own = {"print_level": 0, "tol": 1e-7, "mu_init": barrier, "max_iter": MAX_ITER}
    if solver == "fatrop":
        common |= {"structure_detection": "auto", "equality": equal}
    else:
        own |= {"sb": "yes", "linear_solver": "mumps", "acceptable_tol": 1e-6}
    return common | {f"{solver}.{key}": value for key, value in own.items()}
