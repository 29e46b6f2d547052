"""Trajectories and trees: bounds, limits, clearances, consistency."""

import math

import numpy as np
import protean_robotics as pr
import pytest

PROBLEM = {"bounds": [(-5, -5), (5, 5)], "v_max": 0.5, "omega_max": 2.0}


def test_a_straight_trajectory_takes_its_length_over_the_speed() -> None:
    plan = pr.trajectory.plan((0, 0, 0), (3, 0), **PROBLEM)
    assert plan.duration == pytest.approx(6.0, rel=1e-9)
    assert plan.length == pytest.approx(3.0, rel=1e-9)
    assert plan.lower_bound <= plan.duration * (1 + 1e-12)
    assert plan.status == "planned"
    # From rest to rest with a trapezoid of speeds: L / v + v / a.
    slow = pr.trajectory.plan(
        (0, 0, 0), (3, 0), start_speed=0, goal_speed=0, acceleration=0.25, **PROBLEM
    )
    assert slow.duration == pytest.approx(6.0 + 2.0, rel=0.02)


def test_a_turn_on_the_spot_takes_its_angle_over_the_rate() -> None:
    plan = pr.trajectory.plan((0, 0, math.pi / 2), (3, 0), v_min=0.0, **PROBLEM)
    # At least the drive, at most a turn before it.
    assert 6.0 < plan.duration <= 6.0 + math.pi / 4 + 1e-6


def test_trajectories_keep_clearance_limits_and_kinematics() -> None:
    discs = np.array([[1.0, 0.1, 0.3], [2.0, -0.2, 0.4], [1.6, 0.9, 0.3]])
    plan = pr.trajectory.plan((0, 0, 0), (3, 0), discs=discs, clearance=0.1, **PROBLEM)
    assert plan.time[0] == 0.0 and plan.time[-1] == pytest.approx(plan.duration)
    assert (np.diff(plan.time) >= 0).all()
    np.testing.assert_allclose(plan.pose[0], (0, 0, 0), atol=1e-6)
    np.testing.assert_allclose(plan.pose[-1, :2], (3, 0), atol=1e-3)
    gaps = np.linalg.norm(plan.pose[:, None, :2] - discs[:, :2], axis=2) - discs[:, 2]
    assert gaps.min() > 0.1 - 2e-3
    assert (abs(plan.v) <= 0.5 + 1e-6).all() and (abs(plan.omega) <= 2.0 + 1e-6).all()
    way = np.linalg.norm(np.diff(plan.pose[:, :2], axis=0), axis=1).sum()
    assert way == pytest.approx(plan.length, rel=1e-3)
    assert plan.length >= 3.0 and plan.duration >= plan.lower_bound - 1e-9
    steps = np.diff(plan.time) > 1e-9
    speed = 0.5 * (abs(plan.v[1:]) + abs(plan.v[:-1]))
    walked = np.linalg.norm(np.diff(plan.pose[:, :2], axis=0), axis=1)
    np.testing.assert_allclose(walked[steps], (speed * np.diff(plan.time))[steps], atol=5e-3)


def test_a_polygon_blocks_and_a_ring_encloses() -> None:
    box = [(1.0, -1.0), (2.0, -1.0), (2.0, 1.0), (1.0, 1.0)]
    plan = pr.trajectory.plan((0, 0, 0), (3, 0), polygons=[box], clearance=0.1, **PROBLEM)
    assert plan.length > 2 * math.hypot(1.0, 1.0)
    angles = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    ring = np.stack([3 + np.cos(angles), np.sin(angles), np.full(24, 0.2)], axis=1)
    with pytest.raises(pr.Error, match="no path") as raised:
        pr.trajectory.plan((0, 0, 0), (3, 0), discs=ring, clearance=0.1, **PROBLEM)
    assert not isinstance(raised.value, pr.InvalidInput)


def test_an_instance_is_the_same_problem_in_pixels() -> None:
    instance = {
        "cm_per_px": 2.0,
        "vmax_px_s": 25.0,
        "wmax_rad_s": 2.0,
        "buffer_px": 5.0,
        "bounds_px": [-250, -250, 250, 250],
        "start": {"x": 0, "y": 0, "theta": 0},
        "goal": {"x": 150, "y": 0},
        "obstacles": [{"x": 75, "y": 5, "r": 15}],
    }
    pixels = pr.trajectory.plan_instance(instance)
    metres = pr.trajectory.plan(
        (0, 0, 0), (3, 0), discs=[(1.5, 0.1, 0.3)], clearance=0.1, **PROBLEM
    )
    assert pixels.duration == pytest.approx(metres.duration, rel=1e-6)
    assert 0.02 * pixels.length == pytest.approx(metres.length, rel=1e-6)
    del instance["goal"]
    with pytest.raises(pr.InvalidInput, match="goal"):
        pr.trajectory.plan_instance(instance)


def test_invalid_problems_are_named() -> None:
    for changes, text in [
        ({"v_max": 0.0}, "v_max"),
        ({"omega_max": math.nan}, "omega_max"),
        ({"bounds": [(0, 0)]}, "`bounds`"),
        ({"discs": [(1, 1)]}, "`discs`"),
        ({"discs": [(1, 1, -1)]}, "`discs`"),
        ({"discs": [(0, 0, 1)]}, "start"),
        ({"polygons": [[(0, 0), (1, 1)]]}, "`polygons`"),
        ({"clearance": -1.0}, "`clearance`"),
        ({"method": "best"}, "`method`"),
        ({"acceleration": -1.0}, "acceleration"),
        ({"wheels": (1.0,)}, "`wheels`"),
    ]:
        with pytest.raises(pr.InvalidInput, match=text):
            pr.trajectory.plan((0, 0, 0), (3, 0), **{**PROBLEM, **changes})
    with pytest.raises(pr.InvalidInput, match="`goal`"):
        pr.trajectory.plan((0, 0, 0), (3, math.nan), **PROBLEM)


@pytest.fixture(scope="module")
def block() -> pr.Map:
    """A room of 4 m with a square block of 1 m in its middle."""
    blocked = np.zeros((40, 40), dtype=bool)
    blocked[15:25, 15:25] = True
    return pr.Map.from_grid(blocked, 0.1)


def test_a_tree_finds_almost_the_shortest_path(block: pr.Map) -> None:
    start, goal, radius = (0.5, 2.1), (3.5, 2.1), 0.15
    tree = pr.rrt_star.plan(block, start, goal, radius, iterations=2000, seed=1)
    shortest = block.path_length(start, goal, radius)
    assert tree.reached and shortest - 1e-9 <= tree.cost <= 1.01 * shortest
    walked = np.linalg.norm(np.diff(tree.path, axis=0), axis=1).sum()
    assert walked == pytest.approx(tree.cost)
    assert all(block.line_is_clear(a, b, radius - 1e-6) for a, b in zip(tree.path, tree.path[1:]))


def test_a_tree_is_a_tree_with_the_costs_of_its_edges(block: pr.Map) -> None:
    tree = pr.rrt_star.plan(block, (0.5, 2.1), (3.5, 2.1), 0.15, iterations=300, seed=2)
    assert tree.parents[0] == -1 and (tree.parents[1:] >= 0).all()
    edges = np.linalg.norm(tree.nodes[1:] - tree.nodes[tree.parents[1:]], axis=1)
    np.testing.assert_allclose(tree.costs[1:], tree.costs[tree.parents[1:]] + edges, atol=1e-9)
    same = pr.rrt_star.plan(block, (0.5, 2.1), (3.5, 2.1), 0.15, iterations=300, seed=2)
    np.testing.assert_array_equal(same.nodes, tree.nodes)
    other = pr.rrt_star.plan(block, (0.5, 2.1), (3.5, 2.1), 0.15, iterations=300, seed=3)
    assert other.nodes.shape != tree.nodes.shape or (other.nodes != tree.nodes).any()


def test_a_pursuer_on_one_side_makes_the_other_cheaper(block: pr.Map) -> None:
    start, goal = (0.5, 2.1), (3.5, 2.1)
    plain = pr.rrt_star.plan(block, start, goal, 0.15, seed=1)
    assert plain.path[1:-1, 1].min() > 2.1
    chased = pr.rrt_star.plan(
        block, start, goal, 0.15, seed=1, pursuers=[(2.0, 3.0)], pursuer_speed=0.0
    )
    assert chased.path[1:-1, 1].max() < 2.1


def test_arcs_turn_no_faster_than_the_robot(block: pr.Map) -> None:
    tree = pr.rrt_star.plan(
        block,
        (0.5, 1.0, 0.0),
        (3.4, 3.4),
        0.15,
        seed=1,
        iterations=3000,
        v_max=0.5,
        omega_max=2.0,
        params={"primitive": "arc"},
    )
    assert tree.reached
    assert tree.cost >= block.path_length((0.5, 1.0), (3.4, 3.4), 0.15) - 1e-9


def test_a_goal_without_a_path_is_approached() -> None:
    wall = np.zeros((20, 40), dtype=bool)
    wall[:, 20] = True
    map = pr.Map.from_grid(wall, 0.1)
    tree = pr.rrt_star.plan(map, (0.5, 1.0), (3.5, 1.0), 0.1, seed=1, iterations=200)
    assert not tree.reached and tree.path[-1, 0] > 1.5


def test_invalid_searches_are_named(block: pr.Map) -> None:
    for call, text in [
        (lambda: pr.rrt_star.plan(block, (0.5, 0.5), (3, 3), -0.1), "`radius`"),
        (lambda: pr.rrt_star.plan(block, (2.0, 2.0), (3, 3), 0.1), "free place"),
        (lambda: pr.rrt_star.plan(block, (0.5, 0.5), np.zeros((0, 2)), 0.1), "goals"),
        (lambda: pr.rrt_star.plan(block, (0.5, math.nan), (3, 3), 0.1), "`start`"),
        (
            lambda: pr.rrt_star.plan(block, (0.5, 0.5), (3, 3), 0.1, iterations=10**9),
            "`iterations`",
        ),
        (lambda: pr.rrt_star.plan(block, (0.5, 0.5), (3, 3), 0.1, v_max=0.0), "`v_max`"),
        (
            lambda: pr.rrt_star.plan(
                block, (0.5, 0.5), (3, 3), 0.1, params={"search": {"max_edge": -1}}
            ),
            "max_edge",
        ),
    ]:
        with pytest.raises(pr.InvalidInput, match=text):
            call()
