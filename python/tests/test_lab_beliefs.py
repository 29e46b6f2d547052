"""Consistency of beliefs with the true states."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from protean_robotics.lab.beliefs import Consistency

Table = dict[str, NDArray[Any]]


def game(spread: float, ticks: int = 2000, particles: int = 100) -> tuple[Table, Table]:
    """Gaussian beliefs of deviation 1 about a robot whose true deviation from their means is `spread`."""
    random = np.random.default_rng(7)
    true = random.normal(0.0, spread, (ticks, 2))
    cloud = random.normal(0.0, 1.0, (ticks, particles, 2))
    rows = np.repeat(np.arange(ticks), particles)
    one, zero = np.ones(rows.size), np.zeros(rows.size)
    belief = {
        "stamp.tick": rows,
        "robot": np.full(rows.size, 4),
        "mean_x": zero,
        "mean_y": zero,
        "covariance_xx": one,
        "covariance_xy": zero,
        "covariance_yy": one,
        "effective_sample_size": 80.0 * one,
        "seen": rows % 2,
        "particles.x": cloud[..., 0].ravel(),
        "particles.y": cloud[..., 1].ravel(),
        "particles.weight": one / particles,
    }
    state = {
        "stamp.tick": np.arange(ticks),
        "robots.robot": np.full(ticks, 4),
        "robots.x": true[:, 0],
        "robots.y": true[:, 1],
        "robots.status": np.where(np.arange(ticks) < ticks - 10, 0, 1),
    }
    return belief, state


@pytest.mark.parametrize(("spread", "half", "most", "mean"), [(1.0, 0.5, 0.95, 2.0), (2.0, 0.16, 0.53, 8.0)])
def test_regions_and_normalised_errors_tell_a_consistent_belief_from_a_narrow_one(
    spread: float, half: float, most: float, mean: float
) -> None:
    found = Consistency.of(*game(spread))
    # Not of the ticks after the robot was caught.
    assert found.error.size == 1990 and found.seen.sum() == 995
    assert np.mean(found.enclosed <= 0.5) == pytest.approx(half, abs=0.04)
    assert np.mean(found.enclosed <= 0.95) == pytest.approx(most, abs=0.04)
    assert found.normalised.mean() == pytest.approx(mean, rel=0.1)


def test_logs_are_joined_and_points_left_out() -> None:
    belief, state = game(1.0, ticks=40)
    exact = belief | {name: np.zeros_like(belief[name]) for name in ("covariance_xx", "covariance_yy")}
    both = Consistency.joined([Consistency.of(belief, state), Consistency.of(exact, state)])
    assert both.error.size == 30
    assert both.table().count("\n") == 4 and "| in sight | 15 |" in both.table()
