"""Shares of detected attacks, against loops over all start times in NumPy."""

from pathlib import Path

import numpy as np
import protean_robotics as pr
import pytest

#: Quantile 0.975 of Student's t distribution with 9 degrees of freedom, from tables.
STUDENT = 2.262157


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> pr.Log:
    out = tmp_path_factory.mktemp("logs") / "team.mcap"
    return pr.run("patrol_team", seed=1, set={"rules.time_limit": 150}, in_process=True, out=out).log


def guarded(log: pr.Log, place: tuple[float, float], distance: float) -> tuple[np.ndarray, np.ndarray]:
    """Times of the states, and whether a robot is near the place."""
    state = log["world/state"]
    tick, x, y = (state[name] for name in ("stamp.tick", "robots.x", "robots.y"))
    near = np.hypot(x - place[0], y - place[1]) <= distance
    ticks = np.unique(tick)
    return ticks * 0.05, np.array([near[tick == now].any() for now in ticks])


@pytest.mark.parametrize(("duration", "distance", "start"), [(20.0, 1.0, 40.0), (25.0, 0.5, 0.0), (3.0, 6.0, 10.0)])
def test_shares_are_those_of_every_attack(log: pr.Log, duration: float, distance: float, start: float) -> None:
    places = [(5.0, 0.0), (2.5, 2.5), (0.0, 7.5), (15.0, 7.5), (7.5, 7.5)]
    found = pr.patrol.detection(log, duration=duration, distance=distance, places=places, start=start)
    shares, intervals = [], []
    for place in places:
        times, near = guarded(log, place, distance)
        starts = [t for t in times if t >= start - 1e-9 and t + duration <= times[-1] + 1e-9]
        detected = np.array([near[(times >= t - 1e-9) & (times <= t + duration + 1e-9)].any() for t in starts])
        blocks = [block.mean() for block in np.split(detected, np.arange(1, 10) * len(detected) // 10)]
        half = STUDENT * np.std(blocks, ddof=1) / np.sqrt(10)
        shares.append(detected.mean())
        intervals.append(np.clip([detected.mean() - half, detected.mean() + half], 0, 1))
    # Rounding decides whether an attack ends with the log or with a visit.
    assert found["shares"] == pytest.approx(shares, abs=2e-3)
    worst = int(np.argmin(found["shares"]))
    assert found["minimum"] == found["shares"][worst] and np.array_equal(found["worst"], places[worst])
    assert found["interval"] == pytest.approx(intervals[worst], abs=4e-3)


def test_places_and_robots_are_those_of_the_patrol(log: pr.Log) -> None:
    found = pr.patrol.detection(log, duration=20, start=40)
    assert found["places"].shape == (480, 2) and found["shares"].shape == (480,)
    # Places are a tenth of a metre apart, in order around the contour.
    steps = np.diff(np.vstack([found["places"], found["places"][:1]]), axis=0)
    assert np.hypot(*steps.T).max() < 0.11
    fewer = pr.patrol.detection(log, duration=20, start=40, robots=["guard_1", "guard_3"])
    assert fewer["minimum"] < found["minimum"] and np.all(fewer["shares"] <= found["shares"])
    # A longer attack at the same place is detected more often.
    assert pr.patrol.detection(log, duration=40, start=40)["minimum"] > found["minimum"]


def test_what_cannot_be_computed_is_refused(log: pr.Log, tmp_path: Path) -> None:
    with pytest.raises(pr.InvalidInput, match="duration"):
        pr.patrol.detection(log, duration=149.9)
    with pytest.raises(pr.InvalidInput, match="robots"):
        pr.patrol.detection(log, duration=20, robots=["guard_9"])
    without = pr.run("hello", seed=1, in_process=True, out=tmp_path / "hello.mcap").log
    with pytest.raises(pr.InvalidInput, match=r"places = None: expected a value: the log has 0 patrols"):
        pr.patrol.detection(without, duration=1)
