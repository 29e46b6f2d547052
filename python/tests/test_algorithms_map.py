"""Queries of maps against geometry that is known in closed form."""

import math
from pathlib import Path

import numpy as np
import protean_robotics as pr
import pytest

RADIUS = 0.25


@pytest.fixture(scope="module")
def block() -> pr.Map:
    """A room of 4 m with a square block of 1 m in its middle."""
    blocked = np.zeros((40, 40), dtype=bool)
    blocked[15:25, 15:25] = True
    return pr.Map.from_grid(blocked, 0.1)


def length(points: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def test_the_way_around_a_corner_is_two_tangents_and_an_arc(block: pr.Map) -> None:
    start, goal = (1.25, 1.5), (2.5, 2.75)
    exact = 1.0 + RADIUS * math.pi / 2 + 1.0
    assert block.path_length(start, goal, RADIUS) == pytest.approx(exact, abs=1e-9)
    way = block.path(start, goal, RADIUS)
    assert way.dtype == np.float64 and way.shape[1] == 2
    assert way[0].tolist() == list(start) and way[-1].tolist() == list(goal)
    assert exact < length(way) < exact + 0.01
    assert all(block.line_is_clear(a, b, RADIUS - 1e-9) for a, b in zip(way[:-1], way[1:]))


def test_ways_are_symmetric_and_at_least_straight(block: pr.Map) -> None:
    rng = np.random.default_rng(7)
    points = rng.uniform(0.3, 3.7, (60, 2))
    points = points[block.clearance(points) > RADIUS]
    for goal in points[:5]:
        lengths = block.path_length(points, goal, RADIUS)
        straight = np.linalg.norm(points - goal, axis=1)
        assert (lengths >= straight - 1e-12).all()
        back = [block.path_length(goal, p, RADIUS) for p in points]
        np.testing.assert_allclose(lengths, back, atol=1e-9)
        clear = block.line_is_clear(goal, points, RADIUS)
        np.testing.assert_allclose(lengths[clear], straight[clear], atol=1e-12)
        assert (lengths[~clear] > straight[~clear]).all()


def test_no_way_is_an_empty_array(block: pr.Map) -> None:
    wall = np.zeros((20, 20), dtype=bool)
    wall[:, 10] = True
    divided = pr.Map.from_grid(wall, 0.1)
    assert divided.path((0.3, 1.0), (1.7, 1.0), 0.1).shape == (0, 2)
    assert divided.path_length((0.3, 1.0), (1.7, 1.0), 0.1) == math.inf
    # The middle of the block is too deep.
    assert block.path((0.5, 0.5), (2.0, 2.0), RADIUS).shape == (0, 2)
    assert block.path_length([], (1.0, 1.0), RADIUS).shape == (0,)


def test_an_end_without_room_is_moved(block: pr.Map) -> None:
    way = block.path((0.1, 2.0), (0.5, 0.5), RADIUS)
    np.testing.assert_allclose(way[0], (RADIUS, 2.0), atol=1e-5)


def test_clearance_is_the_distance_to_the_nearest_wall(block: pr.Map) -> None:
    points = np.array([[0.5, 2.0], [1.0, 2.0], [0.7, 0.3], [1.6, 2.0], [1.2, 1.1]])
    distances = [0.5, 0.5, 0.3, -0.1, math.hypot(0.3, 0.4)]
    np.testing.assert_allclose(block.clearance(points), distances, atol=1e-12)
    assert block.clearance((0.5, 2.0)) == pytest.approx(0.5)
    assert block.clearance(np.zeros((0, 2))).shape == (0,)


def test_runs_end_before_obstacles(block: pr.Map) -> None:
    run = block.free_run((0.5, 2.0), [(3.5, 2.0), (0.5, 3.0)], 0.1)
    np.testing.assert_allclose(run, [0.9, 1.0], atol=0.1)
    assert block.line_is_clear((0.5, 2.0), (3.5, 2.0), 0.1) is False


def test_the_view_of_an_empty_room_is_the_room() -> None:
    room = pr.Map.from_grid(np.zeros((30, 50), dtype=bool), 0.1, (-1.0, 2.0))
    seen = room.visible((0.0, 3.0))
    x, y = seen[:, 0], seen[:, 1]
    area = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    assert area == pytest.approx(5.0 * 3.0, rel=1e-6)
    np.testing.assert_allclose(seen.min(axis=0), (-1.0, 2.0), atol=1e-6)
    disc = room.visible((1.5, 3.5), range=0.5)
    np.testing.assert_allclose(np.linalg.norm(disc - (1.5, 3.5), axis=1), 0.5, atol=1e-6)
    assert room.visible((9.0, 9.0)).shape == (0, 2)


def test_a_block_hides_what_is_behind_it(block: pr.Map) -> None:
    seen = block.visible((0.5, 2.0))
    assert not ((seen[:, 0] > 2.5) & (abs(seen[:, 1] - 2.0) < 0.5)).any()


def test_grids_come_back_as_they_were_given() -> None:
    rng = np.random.default_rng(3)
    blocked = rng.random((17, 31)) < 0.3
    map = pr.Map.from_grid(blocked, 0.25, (1.0, -2.0))
    np.testing.assert_array_equal(map.grid, blocked)
    assert (map.resolution, map.origin.tolist()) == (0.25, [1.0, -2.0])
    np.testing.assert_allclose(map.bounds, [[1.0, -2.0], [1.0 + 31 / 4, -2.0 + 17 / 4]])
    assert map.clearance_grid.shape == blocked.shape
    assert ((map.clearance_grid <= 0) == blocked).all()
    # Any layout of memory.
    turned = pr.Map.from_grid(np.asfortranarray(blocked), 0.25)
    np.testing.assert_array_equal(turned.grid, blocked)


def test_maps_come_from_scenarios_and_files(tmp_path: Path) -> None:
    city = pr.Map("chase")
    file = tmp_path / "room.toml"
    file.write_text("bounds = { min = [0.0, 0.0], max = [4.0, 2.0] }\nresolution = 0.1\n")
    room = pr.Map(file)
    assert room.bounds.tolist() == [[0.0, 0.0], [4.0, 2.0]]
    assert city.bounds.shape == (2, 2) and city.revision == room.revision == 1
    assert "Map from (0.00, 0.00) to (4.00, 2.00)" in repr(room)


class Disc:
    """Stands for a robot."""

    position = np.array([0.5, 0.5])
    radius = 0.1


def test_a_robot_stands_for_its_position_and_radius(block: pr.Map) -> None:
    way = block.path(Disc(), (3.5, 3.5))
    np.testing.assert_array_equal(way, block.path((0.5, 0.5), (3.5, 3.5), 0.1))


@pytest.mark.parametrize(
    "arguments,text",
    [
        (((math.nan, 1.0), (1.0, 1.0), 0.1), "`start` is (nan, 1.0)"),
        (((1.0, 1.0), (1.0, math.inf), 0.1), "`goal` is"),
        (((1.0, 1.0, 1.0), (1.0, 1.0), 0.1), "`start` is"),
        (("ab", (1.0, 1.0), 0.1), "`start` is 'ab'"),
        ((None, (1.0, 1.0), 0.1), "`start` is None"),
        (((1.0, 1.0), (1.0, 1.0), -1.0), "radius = -1"),
        (((1.0, 1.0), (1.0, 1.0), math.nan), "radius = NaN"),
        (((1.0, 1.0), (1.0, 1.0)), "`radius` is None"),
        (([[1.0, 1.0]], (1.0, 1.0), 0.1), "`start` is"),
    ],
)
def test_invalid_arguments_are_named(block: pr.Map, arguments: tuple, text: str) -> None:
    with pytest.raises(pr.InvalidInput) as raised:
        block.path(*arguments)
    assert text in str(raised.value)


def test_invalid_maps_are_refused() -> None:
    cells = np.zeros((4, 4), dtype=bool)
    for make, text in [
        (lambda: pr.Map("no_such_scenario"), "expected"),
        (lambda: pr.Map("no_such_map.yaml"), "no_such_map.yaml"),
        (lambda: pr.Map.from_grid(cells[:0], 0.1), "0"),
        (lambda: pr.Map.from_grid(cells[0], 0.1), "`blocked`"),
        (lambda: pr.Map.from_grid(cells, math.nan), "`resolution`"),
        (lambda: pr.Map.from_grid(cells, 0.1, (math.nan, 0.0)), "`origin`"),
        (lambda: pr.Map.from_grid(cells, 0.1, blur_sigma=-1.0), "sigma"),
    ]:
        with pytest.raises(pr.InvalidInput, match=text):
            make()
    map = pr.Map.from_grid(cells, 0.1)
    for query in [
        lambda: map.clearance([[1.0, math.nan]]),
        lambda: map.clearance(np.zeros((2, 3))),
        lambda: map.line_is_clear((0.1, 0.1), (0.2, 0.2), -0.1),
        lambda: map.free_run((0.1, 0.1), (0.2, 0.2), math.nan),
        lambda: map.visible((0.1, 0.1), 0.0),
        lambda: map.visible((0.1, 0.1), heading=math.inf),
    ]:
        with pytest.raises(pr.InvalidInput):
            query()
