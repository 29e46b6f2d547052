"""Consistency of beliefs with the true states."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import protean_robotics as pr
from protean_robotics.lab.beliefs import Consistency


def expected(belief: dict[str, NDArray[Any]], state: dict[str, NDArray[Any]]) -> list[list[float]]:
    """The rows of the table ``beliefs``, from those of the topics."""
    columns = (state[f"robots.{name}"] for name in ("robot", "x", "y", "status"))
    rows = zip(state["stamp.tick"], *columns, strict=True)
    truth = {(tick, robot): (x, y) for tick, robot, x, y, status in rows if status == 0}
    keys = list(zip(belief["stamp.tick"].tolist(), belief["robot"].tolist(), strict=True))
    starts = [i for i, key in enumerate(keys) if i == 0 or keys[i - 1] != key]
    found = []
    for first, end in zip(starts, [*starts[1:], len(keys)], strict=True):
        if keys[first] not in truth:
            continue
        mean = np.array((belief["mean_x"][first], belief["mean_y"][first]))
        xx, xy, yy = (belief[f"covariance_{name}"][first] for name in ("xx", "xy", "yy"))
        covariance, off = np.array(((xx, xy), (xy, yy))), np.array(truth[keys[first]]) - mean
        deviation = np.sqrt(np.trace(covariance))
        enclosed = normalised = np.nan
        if deviation >= 1e-3 and np.linalg.det(covariance) > 0.0:
            inverse = np.linalg.inv(covariance)
            normalised = off @ inverse @ off
            at = np.column_stack((belief["particles.x"][first:end], belief["particles.y"][first:end])) - mean
            nearer = np.einsum("ij,jk,ik->i", at, inverse, at) < normalised
            enclosed = belief["particles.weight"][first:end][nearer].sum(dtype=float)
        effective = belief["effective_sample_size"][first]
        found.append([belief["seen"][first], enclosed, np.hypot(*off), deviation, normalised, effective])
    return found


def test_the_table_of_beliefs_has_their_errors(tmp_path: Path) -> None:
    run = pr.run("chase", seed=1, set={"rules.time_limit": 8}, in_process=True, out=tmp_path / "chase.mcap")
    log = run.log
    table = log.beliefs.to_numpy()
    names = ("seen", "enclosed", "error_m", "deviation_m", "normalised_error", "effective_particles")
    found = np.column_stack([np.asarray(table[name], dtype=float) for name in names])
    rows = np.array(expected(log["perception/belief"].to_numpy(), log["world/state"].to_numpy()), dtype=float)
    assert found.shape == rows.shape and rows.shape[0] > 100
    assert np.isfinite(rows).all(axis=1).any()
    # A particle on the edge of the region counts to either side.
    np.testing.assert_allclose(found, rows, rtol=1e-6, atol=5e-3)


def beliefs(spread: float, ticks: int = 2000) -> dict[str, NDArray[Any]]:
    """Gaussian beliefs of deviation 1 about a robot whose true deviation from their means is `spread`."""
    true = np.random.default_rng(7).normal(0.0, spread, (ticks, 2))
    squared = (true**2).sum(axis=1)
    return {
        "seen": np.arange(ticks) % 2 == 1,
        "enclosed": 1.0 - np.exp(-squared / 2.0),
        "error_m": np.sqrt(squared),
        "deviation_m": np.full(ticks, 2.0**0.5),
        "normalised_error": squared,
        "effective_particles": np.full(ticks, 80.0),
    }


@pytest.mark.parametrize(("spread", "half", "most", "mean"), [(1.0, "50 %", "95 %", "2.0"), (2.0, "16 %", "53 %", "8.0")])
def test_regions_and_normalised_errors_tell_a_consistent_belief_from_a_narrow_one(
    spread: float, half: str, most: str, mean: str
) -> None:
    table = Consistency.of(beliefs(spread, 200_000)).table()
    for share in (half, most):
        assert f"| {share.replace(' ', '')} |" in table, table
    assert f"| {mean} |" in table


def test_logs_are_joined_and_points_left_out() -> None:
    some = beliefs(1.0, ticks=40)
    points = some | {"enclosed": np.full(40, np.nan), "normalised_error": np.full(40, np.nan)}
    both = Consistency.joined([Consistency.of(some), Consistency.of(points)])
    assert both.error.size == 40
    assert both.table().count("\n") == 4 and "| in sight | 20 |" in both.table()
