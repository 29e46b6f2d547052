"""Whether a solution is drivable: looked at between the nodes, with nothing of the program's code."""

import math

import numpy as np

FINE = 40  # samples per interval
RELATIVE = 1e-3  # tolerance of speeds, turn rates and accelerations above their limits
SLOW = 1e-6  # share of v_max below which a velocity has no direction


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
    """Check a solution of `collocation.Program`."""
    if not solution.converged:
        finding = Finding(solution.time, len(instance.radii))
        finding.reasons.append(solution.status)
        return finding
    if instance.has_dynamics:
        return integrate_again(instance, solution)
    return along_parabolas(instance, solution)


def along_parabolas(instance, solution):
    """The trapezoid rule in position is a velocity that changes linearly within an interval.

    That curve is what is driven: heading and turn rate are those of its tangent. Where it turns
    faster than allowed, it is driven slower, and where it stops and goes on in another direction,
    the robot turns on the spot; the time of both is added.
    """
    finding = Finding(solution.time, len(instance.radii))
    nodes, h = solution.states, solution.durations
    velocity = nodes[:, 3:4] * np.column_stack([np.cos(nodes[:, 2]), np.sin(nodes[:, 2])])
    s = np.linspace(0.0, 1.0, FINE + 1)[None, :, None]
    start, change = velocity[:-1, None, :], np.diff(velocity, axis=0)[:, None, :]
    points = nodes[:-1, None, :2] + h[:, None, None] * (start * s + 0.5 * change * s * s)
    look_at_places(instance, finding, points.reshape(-1, 2))
    gaps = np.hypot(*(points[:, -1] - nodes[1:, :2]).T)
    finding.need(gaps.max() <= 1e-3, f"jumps by {gaps.max():.3g} px")
    look_at_ends(instance, finding, nodes)
    speed = np.abs(nodes[:, 3]).max()
    finding.need(speed <= instance.v_max * (1 + RELATIVE), f"drives {speed:.4g} px/s")

    heading = instance.start_theta
    for k in range(len(h)):
        u0, u1 = velocity[k], velocity[k + 1]
        if nodes[k, 3] * nodes[k + 1, 3] < 0.0:
            # A change between forward and backward: stop and turn.
            finding.time += abs(wrapped(nodes[k + 1, 2] - nodes[k, 2])) / instance.w_max
            heading = nodes[k + 1, 2]
            continue
        backwards = math.pi if min(nodes[k, 3], nodes[k + 1, 3]) < 0.0 else 0.0
        moving = [u for u in (u0, u1) if np.hypot(*u) > SLOW * instance.v_max]
        if not moving:
            continue
        first, last = (math.atan2(u[1], u[0]) + backwards for u in (moving[0], moving[-1]))
        finding.time += abs(wrapped(first - heading)) / instance.w_max
        heading = last
        finding.time += slowed_down(u0, u1, h[k], instance)
    if instance.goal_theta is not None:
        finding.time += abs(wrapped(instance.goal_theta - heading)) / instance.w_max
    return finding


def slowed_down(u0, u1, h, instance):
    """Extra duration of an interval so that the turn rate keeps its limit."""
    change = u1 - u0
    cross = abs(u0[0] * change[1] - u0[1] * change[0])
    if cross <= 1e-12 * instance.v_max**2:
        return 0.0
    nearest = min(1.0, max(0.0, -float(u0 @ change) / float(change @ change)))
    if cross / h <= instance.w_max * float(np.sum((u0 + nearest * change) ** 2)):
        return 0.0
    s = np.linspace(0.0, 1.0, 4001)
    s = 0.5 * (s[1:] + s[:-1])
    rate = cross / h / np.sum((u0[None, :] + s[:, None] * change[None, :]) ** 2, axis=1)
    return h * float(np.mean(np.maximum(rate / instance.w_max - 1.0, 0.0)))


def integrate_again(instance, solution):
    """Integrate speeds and turn rates that change linearly within an interval."""
    finding = Finding(solution.time, len(instance.radii))
    nodes, h = solution.states, solution.durations
    v, w = nodes[:, 3], nodes[:, 4]
    step = h / FINE
    heading = instance.start_theta + np.concatenate([[0.0], np.cumsum(h * 0.5 * (w[1:] + w[:-1]))])
    s = (np.arange(FINE)[:, None] + np.array([0.5 - math.sqrt(1 / 12), 0.5 + math.sqrt(1 / 12)])) / FINE
    speed = v[:-1, None, None] + np.diff(v)[:, None, None] * s
    rate = w[:-1, None, None] * s + 0.5 * np.diff(w)[:, None, None] * s * s
    angle = heading[:-1, None, None] + h[:, None, None] * rate
    moves = [np.mean(speed * f(angle), axis=2) * step[:, None] for f in (np.cos, np.sin)]
    points = np.vstack([[instance.start], np.column_stack([m.ravel() for m in moves])]).cumsum(axis=0)
    look_at_places(instance, finding, points)
    miss = math.dist(points[-1], instance.goal)
    finding.need(miss <= instance.millimetre, f"misses the goal by {miss:.3g} px")
    driven = nodes.copy()
    driven[:, 2] = heading
    look_at_ends(instance, finding, driven)
    if instance.goal_theta is not None:
        off = abs(wrapped(heading[-1] - instance.goal_theta))
        finding.need(off <= 1e-4, f"ends {off:.3g} rad off its heading")
    look_at_rates(instance, finding, v, w)
    for name, values, limit in (
        ("speeds up by", np.diff(v) / h, instance.acceleration),
        ("turns up by", np.diff(w) / h, instance.angular_acceleration),
    ):
        if limit is not None:
            worst = np.abs(values).max()
            finding.need(worst <= limit * (1 + RELATIVE), f"{name} {worst:.4g} per s^2")
    return finding


def look_at_rates(instance, finding, v, w):
    speed, rate = np.abs(v).max(), np.abs(w).max()
    finding.need(speed <= instance.v_max * (1 + RELATIVE), f"drives {speed:.4g} px/s")
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
