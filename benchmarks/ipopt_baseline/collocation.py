"""Minimum time by direct collocation: the unicycle's nonlinear program for CasADi and IPOPT."""

import math
import time as clock
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

# Lengths are in hundreds of pixels within the program, so that its variables are about 1.
UNIT = 100.0
# Nodes and weights on [0, 1].
GAUSS = [
    (0.5 - math.sqrt(0.15), 5.0 / 18.0),
    (0.5, 4.0 / 9.0),
    (0.5 + math.sqrt(0.15), 5.0 / 18.0),
]
CONVERGED = ("Solve_Succeeded", "Solved_To_Acceptable_Level")


@dataclass
class Options:
    """Options of the program."""

    intervals: int = 80
    # "trapezoid", "gauss", or "auto": gauss where accelerations or wheels are limited.
    scheme: str = "auto"
    # Number of parts with equally many intervals and independent durations.
    segments: int = 1
    reverse: bool = False
    max_iter: int = 1000
    # Initial barrier parameter: lower for a guess close to a solution.
    barrier: float = 1e-2

    def scheme_for(self, instance):
        if self.scheme != "auto":
            return self.scheme
        return "gauss" if instance.has_dynamics else "trapezoid"


@dataclass
class Solution:
    """States x, y, theta, v, w at the nodes (pixels), durations of the intervals, and the effort."""

    states: np.ndarray
    durations: np.ndarray
    status: str
    iterations: int
    solve_ms: float

    @property
    def converged(self):
        return self.status in CONVERGED

    @property
    def refined(self):
        """States and durations for twice as many intervals."""
        halves = 0.5 * (self.states[1:] + self.states[:-1])
        states = np.empty((2 * len(self.durations) + 1, 5))
        states[::2], states[1::2] = self.states, halves
        return states, np.repeat(0.5 * self.durations, 2)

    @property
    def time(self):
        return float(np.sum(self.durations))


@dataclass
class Program:
    """The program of one instance; the discs' radii and the guess may still change."""

    instance: object
    options: Options
    build_ms: float = field(init=False)

    def __post_init__(self):
        begin = clock.process_time()
        self._build()
        self.build_ms = 1e3 * (clock.process_time() - begin)

    def _build(self):
        inst, n, m = self.instance, self.options.intervals, self.options.segments
        if n % m:
            raise ValueError(f"{n} intervals cannot be shared by {m} segments")
        scheme = self.options.scheme_for(inst)
        x, y, th, v, w = (ca.SX.sym(name, n + 1) for name in ("x", "y", "th", "v", "w"))
        parts = ca.SX.sym("h", m)  # duration of one interval of each part
        h = ca.vertcat(*[parts[k * m // n] for k in range(n)]) if m > 1 else ca.repmat(parts, n, 1)
        dv, dw = v[1:] - v[:-1], w[1:] - w[:-1]
        if scheme == "trapezoid":
            vx, vy = v * ca.cos(th), v * ca.sin(th)
            step_x, step_y = 0.5 * (vx[:-1] + vx[1:]), 0.5 * (vy[:-1] + vy[1:])
        else:
            # Speed and turn rate are linear within an interval, so this is almost exact.
            step_x = step_y = 0
            for s, weight in GAUSS:
                angle = th[:-1] + h * (s * w[:-1] + 0.5 * s * s * dw)
                speed = v[:-1] + s * dv
                step_x += weight * speed * ca.cos(angle)
                step_y += weight * speed * ca.sin(angle)
        rows, low, high = [], [], []

        def add(expression, lower, upper):
            rows.append(expression)
            low.append(np.full(expression.numel(), lower))
            high.append(np.full(expression.numel(), upper))

        add(x[1:] - x[:-1] - h * step_x, 0.0, 0.0)
        add(y[1:] - y[:-1] - h * step_y, 0.0, 0.0)
        add(th[1:] - th[:-1] - 0.5 * h * (w[:-1] + w[1:]), 0.0, 0.0)
        for limit, change in (
            (inst.acceleration and inst.acceleration / UNIT, dv),
            (inst.angular_acceleration, dw),
        ):
            if limit is not None:
                add(change - limit * h, -np.inf, 0.0)
                add(change + limit * h, 0.0, np.inf)
        if inst.wheel_speed is not None:
            half, limit = 0.5 * inst.wheel_separation / UNIT, inst.wheel_speed / UNIT
            add(v + half * w, -limit, limit)
            add(v - half * w, -limit, limit)
        # A chord between nodes of at most v_max h, both at sqrt(r^2 + chord^2 / 4) or more from a
        # centre, keeps r from it. The ends are given, so only the nodes between are bound.
        discs = len(inst.radii)
        r2 = ca.SX.sym("r2", discs)
        if discs and n > 1:
            cx, cy = (ca.DM(inst.centres[:, i] / UNIT).T for i in (0, 1))
            longest = ca.fmax(h[:-1], h[1:]) if m > 1 else h[:-1]
            chord = (inst.v_max / UNIT * longest) ** 2 / 4.0
            ones = ca.DM.ones(1, discs)
            away = (x[1:-1] @ ones - ca.repmat(cx, n - 1, 1)) ** 2
            away += (y[1:-1] @ ones - ca.repmat(cy, n - 1, 1)) ** 2
            add(ca.vec(away - ca.repmat(r2.T, n - 1, 1) - chord @ ones), 0.0, np.inf)
        total = ca.sum1(parts) * (n // m)
        # A small cost keeps an otherwise undetermined turn rate small.
        calm = 1e-6 * ca.sumsqr(dw)
        variables = ca.vertcat(x, y, th, v, w, parts)
        settings = {
            "print_time": False,
            "error_on_fail": False,
            "ipopt.print_level": 0,
            "ipopt.sb": "yes",
            "ipopt.linear_solver": "mumps",
            "ipopt.hessian_approximation": "exact",
            "ipopt.max_iter": self.options.max_iter,
            "ipopt.tol": 1e-7,
            "ipopt.acceptable_tol": 1e-6,
            "ipopt.mu_strategy": "monotone",
            "ipopt.mu_init": self.options.barrier,
        }
        nlp = {"x": variables, "f": total + calm, "g": ca.vertcat(*rows), "p": r2}
        self._solver = ca.nlpsol("minimum_time", "ipopt", nlp, settings)
        self._low, self._high = np.concatenate(low), np.concatenate(high)

    def solve(self, guess, time, grown=None):
        """Solves from states and a time (or durations). `grown` adds to the discs' radii, in pixels."""
        inst, n, m = self.instance, self.options.intervals, self.options.segments
        begin = clock.process_time()
        states = np.array(guess, dtype=float)
        states[:, [0, 1, 3]] /= UNIT
        if np.ndim(time):
            durations = np.asarray(time, dtype=float).reshape(m, n // m).mean(axis=1)
        else:
            durations = np.full(m, time / n)
        shortest = math.dist(inst.start, inst.goal) / inst.v_max
        v_max = inst.v_max / UNIT
        x0, y0, x1, y1 = (edge / UNIT for edge in inst.bounds)
        turn = 1e3
        low = np.tile([x0, y0, -turn, -v_max if self.options.reverse else 0.0, -inst.w_max], (n + 1, 1))
        high = np.tile([x1, y1, turn, v_max, inst.w_max], (n + 1, 1))

        def fix(node, column, value):
            if value is not None:
                low[node, column] = high[node, column] = states[node, column] = value

        fix(0, 0, inst.start[0] / UNIT)
        fix(0, 1, inst.start[1] / UNIT)
        fix(0, 2, inst.start_theta)
        fix(0, 3, None if inst.start_speed is None else inst.start_speed / UNIT)
        fix(0, 4, inst.start_turn_rate)
        fix(n, 0, inst.goal[0] / UNIT)
        fix(n, 1, inst.goal[1] / UNIT)
        fix(n, 3, None if inst.goal_speed is None else inst.goal_speed / UNIT)
        if inst.goal_theta is not None:
            turns = round((states[n, 2] - inst.goal_theta) / (2.0 * math.pi))
            fix(n, 2, inst.goal_theta + 2.0 * math.pi * turns)
        mean = max(shortest, 1e-2) / n
        parts_low = np.full(m, mean if m == 1 else 0.2 * mean)
        parts_high = np.full(m, 50.0 * mean)
        radii = inst.radii + (0.0 if grown is None else grown)
        result = self._solver(
            x0=np.concatenate([states.T.ravel(), durations]),
            lbx=np.concatenate([low.T.ravel(), parts_low]),
            ubx=np.concatenate([high.T.ravel(), parts_high]),
            lbg=self._low,
            ubg=self._high,
            p=(radii / UNIT) ** 2,
        )
        stats = self._solver.stats()
        values = np.asarray(result["x"]).ravel()
        nodes = values[:-m].reshape(5, n + 1).T.copy()
        nodes[:, [0, 1, 3]] *= UNIT
        return Solution(
            states=nodes,
            durations=np.repeat(values[-m:], n // m),
            status=stats["return_status"],
            iterations=int(stats["iter_count"]),
            solve_ms=1e3 * (clock.process_time() - begin),
        )
