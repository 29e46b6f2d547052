"""Fields and linearisation against their formulas; followers in simulated drives."""

import math

import numpy as np
import protean_robotics as pr
import pytest

BEAMS = np.linspace(-np.pi, np.pi, 360, endpoint=False)


def moved(pose: np.ndarray, v: float, omega: float, dt: float) -> np.ndarray:
    """The pose after a tick: exact for constant speeds."""
    x, y, theta = pose
    middle = theta + 0.5 * omega * dt
    chord = v * dt * np.sinc(0.5 * omega * dt / np.pi)
    return np.array(
        [x + chord * math.cos(middle), y + chord * math.sin(middle), theta + omega * dt]
    )


def test_attraction_points_along_the_weighted_mean_direction() -> None:
    points = np.array([[0.0, 0.0], [1.0, 2.0], [-3.0, 0.5]])
    field = pr.steering.attraction(points, [(5.0, 1.0)])
    to_goal = np.array([5.0, 1.0]) - points
    expected = 2.0 * to_goal / np.linalg.norm(to_goal, axis=1, keepdims=True)
    np.testing.assert_allclose(field, expected)
    both = pr.steering.attraction((0, 0), [(90.0, 0.0), (0.0, 90.0)], [3.0, 4.0])
    np.testing.assert_allclose(both, [1.2, 1.6])
    assert pr.steering.attraction((1, 1), (1, 1)).tolist() == [0.0, 0.0]
    assert pr.steering.attraction(points, np.zeros((0, 2))).tolist() == [[0.0, 0.0]] * 3


def test_repulsion_falls_with_the_square_of_the_distance() -> None:
    distance = np.array([0.7, 1.0, 2.0, 4.0])
    field = pr.steering.repulsion(np.stack([distance, 0 * distance], axis=1), (0, 0))
    raw = distance**-2 * math.hypot(1.0, 0.1) / 1.1
    np.testing.assert_allclose(np.linalg.norm(field, axis=1), 2 * np.tanh(raw / 2))
    # Turned slightly clockwise.
    np.testing.assert_allclose(field[:, 1] / field[:, 0], -0.1)
    weak = pr.steering.repulsion((1, 0), (0, 0), params={"speed": 0.5})
    assert np.linalg.norm(weak) < 0.5


def test_a_wall_pushes_with_the_slope_of_its_blur() -> None:
    blocked = np.zeros((150, 200), dtype=bool)
    blocked[:, :100] = True
    map = pr.Map.from_grid(blocked, 0.02, (-2.0, 0.0), blur_sigma=0.19)
    x = np.array([0.25, 0.3, 0.4])
    push = pr.steering.obstacle_push(map, np.stack([x, 0 * x + 1.5], axis=1))
    slope = np.exp(-0.5 * (x / 0.19) ** 2) / (0.19 * math.sqrt(2 * math.pi))
    np.testing.assert_allclose(push[:, 0], 4.4 * slope, rtol=0.02)
    np.testing.assert_allclose(push[:, 1], 0.0, atol=1e-6)


def test_linearisation_is_the_inverse_of_the_kinematics() -> None:
    rng = np.random.default_rng(2)
    for theta in rng.uniform(-3, 3, 50):
        ahead = np.array([math.cos(theta), math.sin(theta)])
        aside = np.array([-ahead[1], ahead[0]])
        wanted = 0.2 * ahead + 0.05 * rng.uniform(-1, 1) * aside
        v, omega = pr.steering.linearise(wanted, theta, v_max=0.5, omega_max=2.0)
        np.testing.assert_allclose(v * ahead + 0.15 * omega * aside, wanted, atol=1e-12)
    assert pr.steering.linearise((0.0, 0.0), 1.0, v_max=0.5, omega_max=2.0) == (0.0, 0.0)


def drive_by_scans(map: pr.Map, goal: np.ndarray, ticks: int) -> np.ndarray | None:
    """The end of a drive by TangentBug; None if it reports that no path leads to the goal."""
    radius, dt = 0.1, 0.05
    bug = pr.steering.TangentBug(radius)
    pose = np.array([0.6, 2.05, 0.0])
    for _ in range(ticks):
        ranges = map.cast_rays(pose[:2], pose[2] + BEAMS, 1.5)
        advice = bug.advise(pose, ranges, goal, angles=BEAMS, range_max=1.5)
        if advice is None:
            return None
        command = pr.steering.go_to(pose, advice[0], v_max=0.5, omega_max=3.0, dt=dt)
        pose = moved(pose, *command, dt)
        assert map.clearance(pose[:2]) > radius
        if np.linalg.norm(pose[:2] - goal) < 0.05:
            break
    return pose[:2]


def test_tangent_bug_drives_around_an_unknown_block() -> None:
    blocked = np.zeros((40, 40), dtype=bool)
    blocked[12:28, 18:22] = True
    end = drive_by_scans(pr.Map.from_grid(blocked, 0.1), np.array([3.4, 2.0]), 600)
    assert end is not None and np.linalg.norm(end - (3.4, 2.0)) < 0.06


def test_tangent_bug_gives_up_on_an_enclosed_goal() -> None:
    blocked = np.zeros((40, 40), dtype=bool)
    blocked[14:27, 22:35] = True
    blocked[16:25, 24:33] = False
    assert drive_by_scans(pr.Map.from_grid(blocked, 0.1), np.array([2.85, 2.05]), 3000) is None


def test_a_tracker_converges_to_its_path_and_arrives() -> None:
    tracker = pr.steering.PathTracker(
        [(0, 0), (3, 0)], params={"arrival_deceleration": 0.5, "arrived": 0.02}
    )
    pose = np.array([0.0, 0.2, 0.3])
    for _ in range(400):
        pose = moved(pose, *tracker.track(pose, v_max=0.5, omega_max=3.0), 0.05)
    assert tracker.arrived and tracker.length == 3.0
    assert tracker.progress == pytest.approx(3.0, abs=0.03)
    np.testing.assert_allclose(pose[:2], (3.0, 0.0), atol=0.03)


def test_invalid_input_is_named() -> None:
    bug = pr.steering.TangentBug(0.1)
    ranges = np.full(360, np.inf)
    for call, text in [
        (lambda: pr.steering.attraction((0, math.nan), (1, 1)), "`points`"),
        (lambda: pr.steering.attraction((0, 0), (1, 1), [1.0, 2.0]), "`weights`"),
        (lambda: pr.steering.attraction((0, 0), (1, 1), [-1.0]), "`weights`"),
        (lambda: pr.steering.repulsion((0, 0), (1, 1), params={"reach": 0}), "`reach`"),
        (lambda: pr.steering.linearise((0, 0), math.nan, v_max=1, omega_max=1), "`heading`"),
        (lambda: pr.steering.linearise((0, 0), 0, v_max=0, omega_max=1), "`v_max`"),
        (lambda: pr.steering.TangentBug(-1.0), "`radius`"),
        (lambda: bug.advise((0, 0, 0), [], (1, 1), angles=[], range_max=1.0), "`ranges`"),
        (lambda: bug.advise((0, 0, 0), ranges, (1, 1)), "`range_max`"),
        (lambda: bug.advise((0, 0, 0), ranges, (1, 1), range_max=1.0), "`angles`"),
        (
            lambda: bug.advise((0, 0, 0), ranges, (1, 1), angles=BEAMS**2, range_max=1.0),
            "`angles`",
        ),
        (
            lambda: bug.advise(
                (0, 0, 0), np.full(360, math.nan), (1, 1), angles=BEAMS, range_max=1.0
            ),
            "`ranges`",
        ),
        (lambda: pr.steering.PathTracker(np.zeros((0, 2))), "`path`"),
        (lambda: pr.steering.PathTracker([(0, 0)], params={"look_ahead": -1}), "look_ahead"),
    ]:
        with pytest.raises(pr.InvalidInput, match=text):
            call()
