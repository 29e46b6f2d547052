"""Classes of paths, arrival times and dominance against geometry."""

import math

import numpy as np
import protean_robotics as pr
import pytest


@pytest.fixture(scope="module")
def room() -> pr.Map:
    """An empty room of 4 m by 3 m."""
    return pr.Map.from_grid(np.zeros((60, 80), dtype=bool), 0.05)


@pytest.fixture(scope="module")
def block() -> pr.Map:
    """A room of 4 m with a square block of 1 m in its middle."""
    blocked = np.zeros((80, 80), dtype=bool)
    blocked[30:50, 30:50] = True
    return pr.Map.from_grid(blocked, 0.05)


def centres(map: pr.Map, shape: tuple[int, ...], pitch: float) -> np.ndarray:
    rows, columns = np.indices(shape)
    return map.origin + pitch * (np.stack([columns, rows], axis=-1) + 0.5)


def length(points: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def test_a_block_has_a_way_on_either_side(block: pr.Map) -> None:
    ways = pr.navigation.shortest_paths(block, (0.5, 2.2), (3.5, 2.2), 0.1, count=2)
    above, below = ways
    assert above[1:-1, 1].min() > 2.5 and below[1:-1, 1].max() < 1.5
    shortest = block.path_length((0.5, 2.2), (3.5, 2.2), 0.1)
    assert shortest <= length(above) < shortest + 0.01 < length(below)
    np.testing.assert_array_equal(above, block.path((0.5, 2.2), (3.5, 2.2), 0.1))
    limited = pr.navigation.shortest_paths(
        block, (0.5, 2.2), (3.5, 2.2), 0.1, count=9, max_length=shortest + 0.05
    )
    assert len(limited) == 1
    assert pr.navigation.shortest_paths(block, (2.0, 2.0), (3.5, 2.2), 0.1) == []


def test_times_in_the_open_are_distances_over_speeds(room: pr.Map) -> None:
    start, speed = np.array([0.725, 1.025]), 0.4
    times = pr.navigation.arrival_times(room, start, speed, 0.1)
    assert times.shape == room.grid.shape and times.dtype == np.float32
    reached = np.isfinite(times)
    # All places where the disc fits.
    np.testing.assert_array_equal(reached, room.clearance_grid >= np.float32(0.1) - 1e-6)
    exact = np.linalg.norm(centres(room, times.shape, 0.05) - start, axis=-1) / speed
    np.testing.assert_allclose(times[reached], exact[reached], rtol=0.02, atol=0.01)


def test_the_first_robot_counts_and_walls_stop_all(room: pr.Map) -> None:
    starts = np.array([[0.725, 1.025], [3.225, 2.025]])
    both = pr.navigation.arrival_times(room, starts, [0.4, 0.8], 0.1)
    each = [
        pr.navigation.arrival_times(room, start, speed, 0.1)
        for start, speed in zip(starts, [0.4, 0.8])
    ]
    np.testing.assert_allclose(both, np.minimum(*each), rtol=0.03, atol=0.02)
    wall = np.zeros((20, 40), dtype=bool)
    wall[:, 20] = True
    divided = pr.Map.from_grid(wall, 0.1)
    times = pr.navigation.arrival_times(divided, (0.5, 1.0), 0.5, 0.1)
    assert np.isinf(times[:, 21:]).all() and np.isfinite(times[10, 5])


def test_equal_robots_divide_the_open_at_their_bisector(room: pr.Map) -> None:
    evader, pursuer = np.array([1.0, 1.0]), np.array([3.0, 2.0])
    owner = pr.navigation.dominance(room, evader, 0.5, pursuer, 0.5, radius=0.1, pitch=0.1)
    places = centres(room, owner.shape, 0.1)
    lead = np.linalg.norm(places - pursuer, axis=-1) - np.linalg.norm(places - evader, axis=-1)
    free = owner > 0
    assert free.mean() > 0.8
    assert (owner[free & (lead > 0.15)] == 2).all()
    assert (owner[free & (lead < -0.15)] == 1).all()
    # A longer arm takes from the evader.
    captured = pr.navigation.dominance(
        room, evader, 0.5, pursuer, 0.5, radius=0.1, pitch=0.1, capture_radius=0.5
    )
    assert (captured == 2).sum() < (owner == 2).sum()


def test_invalid_input_is_named(room: pr.Map) -> None:
    for call, text in [
        (lambda: pr.navigation.shortest_paths(room, (1, 1), (2, 2), 0.0), "`radius`"),
        (lambda: pr.navigation.shortest_paths(room, (1, 1), (2, 2), 0.1, count=10**6), "`count`"),
        (
            lambda: pr.navigation.shortest_paths(room, (1, 1), (2, 2), 0.1, max_length=math.nan),
            "`max_length`",
        ),
        (lambda: pr.navigation.arrival_times(room, (1, 1), -1.0, 0.1), "`speeds`"),
        (lambda: pr.navigation.arrival_times(room, [(1, 1)], [1.0, 2.0], 0.1), "`speeds`"),
        (lambda: pr.navigation.arrival_times(room, (1, math.nan), 1.0, 0.1), "`starts`"),
        (lambda: pr.navigation.arrival_times(room, (1, 1), 1.0, 0.1, pitch=0.0), "`pitch`"),
        (
            lambda: pr.navigation.dominance(room, (1, 1), 1.0, "x", 1.0, radius=0.1),
            "`pursuers`",
        ),
    ]:
        with pytest.raises(pr.InvalidInput, match=text):
            call()
    none = pr.navigation.arrival_times(room, np.zeros((0, 2)), 1.0, 0.1)
    assert np.isinf(none).all()
