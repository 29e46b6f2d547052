"""Steering against closed forms and simulated drives."""

import math

import numpy as np
import protean_robotics as pr
import pytest

LIMITS = {"v_max": 0.5, "omega_max": 2.0, "dt": 0.05}


def moved(pose: np.ndarray, v: float, omega: float, dt: float) -> np.ndarray:
    """The pose after a tick: exact for constant speeds."""
    x, y, theta = pose
    middle = theta + 0.5 * omega * dt
    chord = v * dt * np.sinc(0.5 * omega * dt / np.pi)
    return np.array(
        [x + chord * math.cos(middle), y + chord * math.sin(middle), theta + omega * dt]
    )


def test_a_point_ahead_is_approached_straight_and_one_beside_by_a_turn() -> None:
    assert pr.steering.go_to((0, 0, 0), (2, 0), **LIMITS) == (0.5, 0.0)
    assert pr.steering.go_to((0, 0, 0), (0, 2), **LIMITS) == (0.0, 2.0)
    assert pr.steering.go_to((0, 0, 0), (0, -2), **LIMITS) == (0.0, -2.0)
    assert pr.steering.go_to((1, 2, 0), (1, 2), **LIMITS) == (0.0, 0.0)
    assert pr.steering.go_to((0, 0, 0), np.zeros((0, 2)), **LIMITS) == (0.0, 0.0)


def test_the_arc_to_a_point_has_the_curvature_of_pure_pursuit() -> None:
    slow = {"v_max": 0.5, "omega_max": 9.0, "dt": 0.05, "params": {"turn_gain": 1e-6}}
    v, omega = pr.steering.go_to((0, 0, 0), (2.0, 0.5), **slow)
    bearing, distance = math.atan2(0.5, 2.0), math.hypot(2.0, 0.5)
    assert omega / v == pytest.approx(2 * math.sin(bearing) / distance)


def test_a_robot_follows_the_shortest_way_without_a_collision() -> None:
    blocked = np.zeros((40, 40), dtype=bool)
    blocked[15:25, 15:25] = True
    map = pr.Map.from_grid(blocked, 0.1)
    goal, radius = np.array([3.5, 3.4]), 0.15
    pose = np.array([0.5, 0.6, -2.0])
    ticks = 0
    while np.linalg.norm(pose[:2] - goal) > 0.05:
        way = map.path(pose[:2], goal, radius + 0.03)
        pose = moved(pose, *pr.steering.go_to(pose, way, **LIMITS), LIMITS["dt"])
        assert map.clearance(pose[:2]) > radius
        ticks += 1
        assert ticks < 400


def test_a_way_may_be_computed_once_and_followed_to_its_end() -> None:
    way = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.5], [0.5, 1.5]])
    params = {"deceleration": 1.0}
    pose = np.array([0.0, 0.0, 0.0])
    farthest = 0.0
    for _ in range(400):
        v, omega = pr.steering.go_to(pose, way, **LIMITS, params=params)
        pose = moved(pose, v, omega, LIMITS["dt"])
        parts = [
            np.clip((pose[:2] - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
            for a, b in zip(way, way[1:])
        ]
        feet = [a + t * (b - a) for t, a, b in zip(parts, way, way[1:])]
        farthest = max(farthest, min(float(np.linalg.norm(pose[:2] - foot)) for foot in feet))
    assert np.linalg.norm(pose[:2] - way[-1]) < 0.05 and farthest < 0.2


def test_commands_are_within_the_limits() -> None:
    rng = np.random.default_rng(5)
    for _ in range(200):
        pose, target = rng.uniform(-3, 3, 3), rng.uniform(-3, 3, 2)
        v, omega = pr.steering.go_to(pose, target, **LIMITS)
        assert 0 <= v <= 0.5 and abs(omega) <= 2.0


@pytest.mark.parametrize(
    "change,text",
    [
        ({"v_max": 0.0}, "`v_max`"),
        ({"omega_max": math.nan}, "`omega_max`"),
        ({"dt": 0.0}, "`dt`"),
        ({"v_reverse_max": -1.0}, "`reverse`"),
        ({"params": {"arrived": -1.0}}, "`arrived`"),
        ({"params": {"arrives": 1.0}}, "unknown field `arrives`"),
        ({"params": {"arrived": math.nan}}, "params"),
        ({"params": {"arrived": object()}}, "params"),
    ],
)
def test_invalid_values_are_named(change: dict, text: str) -> None:
    with pytest.raises(pr.InvalidInput, match=text):
        pr.steering.go_to((0, 0, 0), (1, 1), **{**LIMITS, **change})
    with pytest.raises(pr.InvalidInput, match="`pose`"):
        pr.steering.go_to((0, 0), (1, 1), **LIMITS)
