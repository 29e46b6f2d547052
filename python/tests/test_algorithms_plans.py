"""Patrols and coverages: what their papers state, and determinism."""

import math
import re
from collections.abc import Callable

import numpy as np
import protean_robotics as pr
import pytest

SQUARE = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]


def zig_zag(**changes: object) -> pr.patrol.ZigZag:
    values: dict = {"t_max": 32.0, "alpha": 0.5, "key": "catp:0.4,0.644"}
    return pr.patrol.ZigZag(SQUARE, **{**values, **changes})


def test_a_lap_has_the_corners_and_a_waypoint_per_second_between() -> None:
    patrol = zig_zag()
    points, due, inserted = patrol.lap()
    assert (patrol.v, patrol.length, patrol.lap_time) == (0.5, 16.0, 32.0)
    assert len(points) == patrol.waypoints_per_lap == 32
    np.testing.assert_allclose(due, np.arange(1, 33))
    corners = [(4.0, 0.0), (4.0, 4.0), (0.0, 4.0), (0.0, 0.0)]
    assert points[~inserted].tolist() == [list(c) for c in corners]
    # Q = P + v j u + α (X f + (Y − ½) f⊥) with X, Y in [0, 1).
    side = points[:7]
    offset = side - np.stack([0.5 * np.arange(1, 8), np.zeros(7)], axis=1)
    assert (offset[:, 0] >= 0).all() and (offset[:, 0] < 0.5).all()
    assert (abs(offset[:, 1]) <= 0.25).all()


def test_laps_differ_and_the_owner_of_the_key_predicts_them() -> None:
    patrol, ally = zig_zag(), zig_zag()
    laps = [patrol.lap(n)[0] for n in (0, 1, 1000)]
    assert (laps[0] != laps[1]).any() and (laps[1] != laps[2]).any()
    points, due, _ = ally.lap(1000)
    np.testing.assert_array_equal(points, laps[2])
    np.testing.assert_allclose(patrol.predict(due), points, atol=1e-9)
    halfway = patrol.predict(due[:-1] + 0.5)
    np.testing.assert_allclose(halfway, 0.5 * (points[:-1] + points[1:]), atol=1e-6)
    other = zig_zag(key=None, seed=5)
    assert other.key.startswith("catp:") and other.key == zig_zag(key=None, seed=5).key
    assert (other.lap()[0] != laps[0]).any()


def test_an_open_contour_is_driven_there_and_back() -> None:
    patrol = pr.patrol.ZigZag([(0, 0), (2, 0)], t_max=4.0, alpha=0.1, closed=False, seed=1)
    assert patrol.lap(0)[0][-1].tolist() == [2.0, 0.0]
    assert patrol.lap(1)[0][-1].tolist() == [0.0, 0.0]


def test_invalid_patrols_are_refused() -> None:
    for call, text in [
        (lambda: pr.patrol.ZigZag([(0, 0)], t_max=9.0, alpha=0.1), "contour"),
        (lambda: pr.patrol.ZigZag([(0, 0), (1, math.nan)], t_max=9.0, alpha=0.1), "`contour`"),
        (lambda: zig_zag(t_max=0.0), "`t_max`"),
        (lambda: zig_zag(alpha=math.nan), "`alpha`"),
        (lambda: zig_zag(key="catp"), "`key`"),
        (lambda: zig_zag(preset="best"), "`preset`"),
        (lambda: zig_zag().predict(-1.0), "t"),
        (lambda: zig_zag().predict([0.0, math.nan]), "`times`"),
    ]:
        with pytest.raises(pr.InvalidInput, match=text):
            call()


@pytest.fixture(scope="module")
def block() -> pr.Map:
    """A room of 4 m with a square block of 1 m in its middle."""
    blocked = np.zeros((40, 40), dtype=bool)
    blocked[15:25, 15:25] = True
    return pr.Map.from_grid(blocked, 0.1)


def test_rectangles_divide_the_free_space_of_the_centre(block: pr.Map) -> None:
    plan = pr.coverage.Plan(block, (0.5, 0.5), 0.2, seed=1, margin=0.0)
    low, high = plan.rectangles[:, :2], plan.rectangles[:, 2:]
    area = (high - low).prod(axis=1).sum()
    assert area == pytest.approx((4.0 - 0.4) ** 2 - (1.0 + 0.4) ** 2, rel=1e-6)
    assert plan.area == pytest.approx(area)
    rng = np.random.default_rng(1)
    points = rng.uniform(0, 4, (500, 2))
    inside = ((low <= points[:, None]) & (points[:, None] <= high)).all(axis=2)
    # Rectangles round the block have corners: only the square around it is left out.
    free = (abs(points - 2.0) < 1.8).all(axis=1) & ~(abs(points - 2.0) < 0.7).all(axis=1)
    np.testing.assert_array_equal(inside.any(axis=1), free)
    # The tour is a closed walk over bridges through all rectangles.
    stops = plan.tour[:, 0].tolist()
    assert set(stops) == set(range(len(low))) and plan.tour[:, 1].sum() >= 200
    bridges = {frozenset(pair) for pair in plan.bridges.tolist()}
    assert all(frozenset(pair) in bridges for pair in zip(stops, stops[1:] + stops[:1]))


def test_sub_goals_lie_in_the_rectangles_and_follow_from_the_key(block: pr.Map) -> None:
    plan = pr.coverage.Plan(block, (0.5, 0.5), 0.2, seed=1, loops=2, sub_goals=100)
    goals = plan.next(10_000)
    assert 200 <= len(goals) < 10_000 and plan.next(5).shape == (0, 2)
    low, high = plan.rectangles[:, :2], plan.rectangles[:, 2:]
    within = ((low <= goals[:, None] + 1e-9) & (goals[:, None] <= high + 1e-9)).all(axis=2)
    assert within.any(axis=1).all()
    assert (block.clearance(goals) >= 0.2).all()
    same = pr.coverage.Plan(block, (0.5, 0.5), 0.2, key=plan.key, loops=2, sub_goals=100)
    np.testing.assert_array_equal(same.next(10_000), goals)
    other = pr.coverage.Plan(block, (0.5, 0.5), 0.2, seed=2, loops=2, sub_goals=100)
    assert (other.next(100) != goals[:100]).any()


def test_invalid_coverages_are_refused(block: pr.Map) -> None:
    for changes, text in [
        ({"radius": 3.0}, "radius"),
        ({"radius": math.nan}, "`radius`"),
        ({"start": (math.nan, 1.0)}, "`start`"),
        ({"sub_goals": 0}, "`sub_goals`"),
        ({"margin": -1.0}, "`margin`"),
        ({"tolerance": 0.0}, "`tolerance`"),
        ({"key": "none:1"}, "`key`"),
    ]:
        values: dict = {"start": (0.5, 0.5), "radius": 0.2, **changes}
        with pytest.raises(pr.InvalidInput, match=text):
            pr.coverage.Plan(block, values.pop("start"), values.pop("radius"), **values)


def test_routes_of_scenarios_are_planned_without_a_run() -> None:
    laps = pr.patrol.plan("patrol_octagon", laps=2, key="catp:0.4,0.644")
    assert laps["key"].startswith("catp:") and laps["metrics"]["laps"] == 2
    found = pr.patrol.predict(times=[30.0], waypoints=[7], key="catp:0.4,0.644", seed=77)
    assert found["waypoints"] == [laps["waypoints"][7]]
    assert found["at"][0]["from"]["number"] < found["at"][0]["to"]["number"]
    goals = pr.coverage.plan("coverage_case1", goals=10)["sub_goals"]
    assert goals == pr.coverage.plan("coverage_case1", goals=20)["sub_goals"][:10]
    assert pr.coverage.plan("coverage_case1", length=50)["coverage"]["length"] <= 50


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: pr.patrol.predict(times=[-1]), "`t` is -1"),
        (lambda: pr.patrol.predict(times=[float("nan")]), "`t` is NaN"),
        (lambda: pr.patrol.predict(waypoints=[-1]), "waypoints = -1"),
        (lambda: pr.patrol.predict(times=["soon"]), "times = 'soon'"),
        (lambda: pr.patrol.plan(key="garbage"), "garbage"),
        (lambda: pr.patrol.plan(key="catp:0,0"), "all zero"),
        (lambda: pr.patrol.plan("chase"), "chase: no process of kind patrol_awg"),
        (lambda: pr.patrol.plan(process="unknown"), "`unknown`"),
        (lambda: pr.patrol.plan("chaze"), "did you mean `chase`?"),
        (lambda: pr.patrol.plan(laps=0), "laps = 0"),
        (lambda: pr.patrol.plan(laps=10_001), "laps"),
        (lambda: pr.patrol.plan(set={"processes.patrol.params.mission.t_max": 40}), "`t_max` is 40 s"),
        (lambda: pr.coverage.plan("patrol_octagon"), "no process of kind coverage_chebyshev"),
        (lambda: pr.coverage.plan(length=-1), "length"),
        (lambda: pr.coverage.plan(length=float("nan")), "length"),
        (lambda: pr.coverage.plan(loops=2, goals=3), "one of loops, goals and length"),
        (lambda: pr.coverage.plan("coverage_case1", set={"processes.cover.params.follow.margin": 6}), "`follow.margin` is 6 m"),
    ],
)
def test_routes_that_cannot_be_planned_are_refused(call: Callable[[], object], words: str) -> None:
    with pytest.raises(pr.InvalidInput, match=re.escape(words)):
        call()
