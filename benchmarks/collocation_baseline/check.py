"""Whether a solution is drivable: looked at between the nodes, with nothing of the program's code."""

import math

import numpy as np

FINE = 40  # samples per interval
RELATIVE = 1e-3  # tolerance of speeds, turn rates and accelerations above their limits


class Finding:
    """Result of a check: `honest`, the duration, reasons, and the penetration of each disc."""

    def __init__(self, time, discs):
        self.time = time
        self.reasons = []
        self.penetration = np.zeros(discs)

    @property
    def honest(self):
        return not self.reasons

    def need(self, holds, reason):
        if not holds:
            self.reasons.append(reason)


def look(instance, solution):
    """Check a solution of `program.Program`: integrate its speeds and turn rates again."""
    finding = Finding(solution.time, len(instance.radii))
    if not solution.converged:
        finding.reasons.append(solution.status)
        return finding
    nodes, h = solution.states, solution.interval
    v, w = nodes[:, 3], nodes[:, 4]
    dv, dw = (np.diff(v), np.diff(w)) if solution.inertia else (np.zeros(len(v) - 1), np.zeros(len(v) - 1))
    turns = h * (w[:-1] + 0.5 * dw)
    heading = instance.start_theta + np.concatenate([[0.0], np.cumsum(turns)])
    s = (np.arange(FINE)[:, None] + np.array([0.5 - math.sqrt(1 / 12), 0.5 + math.sqrt(1 / 12)])) / FINE
    speed = v[:-1, None, None] + dv[:, None, None] * s
    rate = w[:-1, None, None] * s + 0.5 * dw[:, None, None] * s * s
    angle = heading[:-1, None, None] + h * rate
    moves = [np.mean(speed * f(angle), axis=2) * (h / FINE) for f in (np.cos, np.sin)]
    points = np.vstack([[instance.start], np.column_stack([m.ravel() for m in moves])]).cumsum(axis=0)
    look_at_places(instance, finding, points)
    miss = math.dist(points[-1], instance.goal)
    finding.need(miss <= instance.millimetre, f"misses the goal by {miss:.3g} px")
    if instance.goal_theta is not None:
        off = abs(wrapped(heading[-1] - instance.goal_theta))
        finding.need(off <= 1e-4, f"ends {off:.3g} rad off its heading")
    look_at_rates(instance, finding, v, w)
    look_at_ends(instance, finding, nodes)
    for name, values, limit in (
        ("speeds up by", dv / h, instance.acceleration),
        ("turns up by", dw / h, instance.angular_acceleration),
    ):
        if limit is not None:
            worst = np.abs(values).max()
            finding.need(worst <= limit * (1 + RELATIVE), f"{name} {worst:.4g} per s^2")
    return finding


def look_at_rates(instance, finding, v, w):
    finding.need(v.max() <= instance.v_max * (1 + RELATIVE), f"drives {v.max():.4g} px/s")
    least = instance.v_min - instance.v_max * RELATIVE
    finding.need(v.min() >= least, f"drives backwards at {-v.min():.4g} px/s")
    rate = np.abs(w).max()
    finding.need(rate <= instance.w_max * (1 + RELATIVE), f"turns {rate:.4g} rad/s")
    if instance.wheel_speed is not None:
        wheel = (np.abs(v) + 0.5 * instance.wheel_separation * np.abs(w)).max()
        finding.need(wheel <= instance.wheel_speed * (1 + RELATIVE), f"wheel at {wheel:.4g} px/s")


def look_at_places(instance, finding, points):
    """Check the discs and the edge of the board."""
    if len(instance.radii):
        away = np.full(len(instance.radii), np.inf)
        for chunk in np.array_split(points, max(1, len(points) // 2000)):
            gaps = chunk[:, None, :] - instance.centres[None, :, :]
            away = np.minimum(away, np.hypot(gaps[..., 0], gaps[..., 1]).min(axis=0))
        finding.penetration = np.maximum(instance.radii - away, 0.0)
        worst = finding.penetration.max()
        finding.need(worst <= instance.millimetre, f"enters a disc by {worst:.3g} px")
    x0, y0, x1, y1 = instance.bounds
    out = max(x0 - points[:, 0].min(), points[:, 0].max() - x1, y0 - points[:, 1].min())
    out = max(out, points[:, 1].max() - y1)
    finding.need(out <= instance.millimetre, f"leaves the board by {out:.3g} px")


def look_at_ends(instance, finding, nodes):
    """Check the ends: places, and speeds where they cannot step."""
    if instance.has_inertia:
        for name, got, wanted in (
            ("starts at speed", nodes[0, 3], instance.start_speed),
            ("starts at turn rate", nodes[0, 4], instance.start_turn_rate),
            ("ends at speed", nodes[-1, 3], instance.goal_speed),
        ):
            if wanted is not None:
                finding.need(abs(got - wanted) <= 1e-4, f"{name} {got:.4g}, not {wanted:.4g}")
    for name, got, wanted in (("start", nodes[0], instance.start), ("goal", nodes[-1], instance.goal)):
        off = math.dist(got[:2], wanted)
        finding.need(off <= instance.millimetre, f"is {off:.3g} px off the {name}")


def look_at_samples(instance, plan):
    """Check another planner's samples [[t, x, y, theta, v, omega], ...].

    Between samples the position is the cubic that has the sampled positions and velocities.
    """
    finding = Finding(plan["t_s"], len(instance.radii))
    try:
        samples = np.asarray(plan["samples"], dtype=float).reshape(-1, 6)
    except (KeyError, TypeError, ValueError):
        finding.reasons.append("gave no samples")
        return finding
    if len(samples) < 2 or not np.all(np.isfinite(samples)):
        finding.reasons.append("gave no samples")
        return finding
    t, places, theta, v, w = samples[:, 0], samples[:, 1:3], samples[:, 3], samples[:, 4], samples[:, 5]
    h = np.diff(t)
    finding.need(h.min() >= 0.0, "goes back in time")
    finding.need(abs(t[-1] - t[0] - plan["t_s"]) <= 1e-3, "t_s is not the samples'")
    velocity = v[:, None] * np.column_stack([np.cos(theta), np.sin(theta)])
    s = np.linspace(0.0, 1.0, 11)[None, :, None]
    p0, p1 = places[:-1, None, :], places[1:, None, :]
    m0, m1 = h[:, None, None] * velocity[:-1, None, :], h[:, None, None] * velocity[1:, None, :]
    points = (1 + 2 * s) * (1 - s) ** 2 * p0 + s * (1 - s) ** 2 * m0
    points = points + s * s * (3 - 2 * s) * p1 + s * s * (s - 1) * m1
    look_at_places(instance, finding, points.reshape(-1, 2))
    nodes = samples[:, 1:]
    look_at_ends(instance, finding, nodes)
    off = abs(wrapped(theta[0] - instance.start_theta))
    finding.need(off <= 1e-3, f"starts {off:.3g} rad off its heading")
    if instance.goal_theta is not None:
        off = abs(wrapped(theta[-1] - instance.goal_theta))
        finding.need(off <= 1e-3, f"ends {off:.3g} rad off its heading")
    look_at_rates(instance, finding, v, w)
    # Distance and turn between samples within the maximum speed and turn rate.
    far = np.hypot(*np.diff(places, axis=0).T) - instance.v_max * (1 + RELATIVE) * h
    finding.need(far.max() <= 1e-3, f"covers {far.max():.3g} px too much between samples")
    # Sideways distance within that of a heading between the two sampled ones.
    turned = wrapped(np.diff(theta))
    middle = theta[:-1] + 0.5 * turned
    dx, dy = np.diff(places, axis=0).T
    aside = np.abs(dy * np.cos(middle) - dx * np.sin(middle))
    may = np.hypot(dx, dy) * (np.sin(0.5 * np.abs(turned)) + 0.01)
    finding.need((aside - may).max() <= 1e-2, f"slips {(aside - may).max():.3g} px between samples")
    over = (np.abs(turned) - instance.w_max * (1 + RELATIVE) * h).max()
    finding.need(over <= 1e-3, f"turns {over:.3g} rad too much between samples")
    for name, change, limit in (
        ("px/s", np.abs(np.diff(v)), instance.acceleration),
        ("rad/s", np.abs(np.diff(w)), instance.angular_acceleration),
    ):
        if limit is not None:
            over = (change - limit * (1 + 10 * RELATIVE) * h).max()
            finding.need(over <= 1e-3, f"gains {over:.3g} {name} too much between samples")
    return finding


def wrapped(angle):
    return (angle + math.pi) % (2.0 * math.pi) - math.pi
