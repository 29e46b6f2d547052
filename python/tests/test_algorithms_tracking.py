"""The particle filter on simulated motions, and views of observers."""

import math

import numpy as np
import protean_robotics as pr
import pytest

LIMITS = {"v_max": 0.5, "omega_max": 2.0}


@pytest.fixture(scope="module")
def room() -> pr.Map:
    return pr.Map.from_grid(np.zeros((60, 60), dtype=bool), 0.1)


def test_the_mean_follows_a_robot_that_is_seen(room: pr.Map) -> None:
    rng = np.random.default_rng(4)
    belief = pr.tracking.ParticleFilter(room, seed=3, **LIMITS)
    assert belief.unseen_for == math.inf
    errors = []
    for tick in range(200):
        angle = 0.2 * 0.05 * tick
        truth = np.array([3.0 + 2.0 * math.cos(angle), 3.0 + 2.0 * math.sin(angle)])
        belief.update(0.05, truth + rng.normal(0, 0.2, 2), sigma=0.2)
        errors.append(np.linalg.norm(belief.mean[:2] - truth))
    assert belief.unseen_for == 0.0
    # Better than single measurements, whose mean error is 0.25 m.
    assert np.mean(errors[50:]) < 0.2


def test_particles_are_a_distribution_with_its_moments(room: pr.Map) -> None:
    belief = pr.tracking.ParticleFilter(
        room, (2.0, 3.0, 0.5), seed=1, params={"particles": 300}, **LIMITS
    )
    for _ in range(20):
        belief.update(0.05)
    particles = belief.particles.astype(float)
    assert len(belief) == 300 and particles.shape == (300, 4)
    weights = particles[:, 3]
    assert weights.sum() == pytest.approx(1.0, abs=1e-5) and (weights >= 0).all()
    mean = weights @ particles[:, :2]
    np.testing.assert_allclose(belief.mean[:2], mean, atol=1e-4)
    off = particles[:, :2] - mean
    np.testing.assert_allclose(belief.covariance, (weights * off.T) @ off, atol=1e-4)
    # Within reach of the start, but for those that jumped: a fifth per second.
    reach = np.linalg.norm(particles[:, :2] - (2.0, 3.0), axis=1)
    assert (reach <= 0.5 * 1.0 + 0.1).mean() > 0.7


def test_the_belief_spreads_unseen_and_contracts_when_seen(room: pr.Map) -> None:
    belief = pr.tracking.ParticleFilter(room, (3.0, 3.0, 0.0), seed=2, **LIMITS)
    spread = []
    for _ in range(3):
        for _ in range(20):
            belief.update(0.05)
        spread.append(np.trace(belief.covariance))
    assert spread == sorted(spread) and belief.unseen_for == pytest.approx(3.0)
    belief.update(0.05, (3.5, 3.0), sigma=0.05)
    assert np.trace(belief.covariance) < 0.1 * spread[-1]
    belief.update(0.05, (3.5, 3.0))
    np.testing.assert_allclose(belief.mean[:2], (3.5, 3.0), atol=1e-6)


def test_what_observers_see_empty_holds_no_belief() -> None:
    blocked = np.zeros((60, 60), dtype=bool)
    blocked[:, 29:31] = True
    map = pr.Map.from_grid(blocked, 0.1)
    belief = pr.tracking.ParticleFilter(map, seed=5, **LIMITS)
    left = belief.particles[:, 0] < 2.9
    assert 0.4 < left.mean() < 0.6
    for _ in range(40):
        belief.update(0.05, observers=[(1.5, 3.0, 0.0)])
    assert (belief.particles[:, 0] < 2.9).mean() < 0.05


def test_a_wrong_start_is_left_with_the_first_sightings(room: pr.Map) -> None:
    errors = []
    for seed in range(100):
        rng = np.random.default_rng(seed)
        belief = pr.tracking.ParticleFilter(room, (0.5, 0.5, 0.0), seed=seed, **LIMITS)
        for _ in range(100):
            belief.update(0.05)
        truth = np.array([5.0, 5.0])
        for _ in range(40):
            truth -= 0.05 * 0.5 * np.array([0.8, 0.6])
            belief.update(0.05, truth + rng.normal(0, 0.2, 2), sigma=0.2)
            errors.append(np.linalg.norm(belief.mean[:2] - truth))
    by_tick = np.array(errors).reshape(100, 40)
    print(f"error: {np.median(by_tick[:, 0]):.2f} m, {by_tick[:, 1].max():.2f} m, {by_tick[:, 20:].mean():.2f} m")
    assert np.median(by_tick[:, 0]) < 0.5 and by_tick[:, 1].max() < 0.7
    assert by_tick[:, 20:].mean() < 0.15


def test_equal_corridors_keep_their_shares_until_one_is_seen_empty() -> None:
    blocked = np.zeros((60, 140), dtype=bool)
    blocked[25:35, 20:120] = True
    map = pr.Map.from_grid(blocked, 0.1)
    shares, late = [], []
    for seed in range(100):
        belief = pr.tracking.ParticleFilter(map, (1.0, 3.0, 0.0), seed=seed, **LIMITS)
        for _ in range(400):
            belief.update(0.05)
        x, y, _, weight = belief.particles.astype(float).T
        upper, lower = weight[y > 3.5].sum(), weight[y < 2.5].sum()
        shares.append(upper / (upper + lower))
        belief.update(0.05, observers=[(3.0, 4.7, 0.0)])
        x, y, _, weight = belief.particles.astype(float).T
        late.append(weight[(y > 3.5) & (x > 3.0) & (x < 9.0)].sum())
    print(f"share: {np.mean(shares):.2f}, {np.std(shares):.2f}, {min(shares):.2f} .. {max(shares):.2f}; seen empty: {max(late):.2f}")
    assert abs(np.mean(shares) - 0.5) < 0.02 and min(shares) > 0.3 and max(shares) < 0.7
    assert max(late) < 0.05


def test_the_same_seed_gives_the_same_belief(room: pr.Map) -> None:
    def run(seed: int) -> np.ndarray:
        belief = pr.tracking.ParticleFilter(room, seed=seed, **LIMITS)
        for _ in range(5):
            belief.update(0.05, (1.0, 1.0), sigma=0.3)
        return belief.particles

    np.testing.assert_array_equal(run(1), run(1))
    assert (run(1) != run(2)).any()


def test_views_end_at_walls_ranges_and_fields_of_view(room: pr.Map) -> None:
    seen = pr.tracking.visibility(room, [(3.0, 3.0, 0.0)], [(4.0, 3.0), (2.0, 3.0)])
    assert (seen > 0.9).all()
    ahead = {"field_of_view": 1.0, "range": 2.0}
    points = [(4.0, 3.0), (2.0, 3.0), (5.5, 3.0)]
    limited = pr.tracking.visibility(room, [(3.0, 3.0, 0.0)], points, sensor=ahead)
    assert limited[0] > 0.9 and limited[1:].tolist() == [0.0, 0.0]
    assert pr.tracking.visibility(room, np.zeros((0, 3)), (1, 1)) == 0.0


def test_invalid_input_is_named(room: pr.Map) -> None:
    belief = pr.tracking.ParticleFilter(room, **LIMITS)
    for call, text in [
        (lambda: pr.tracking.ParticleFilter(room, v_max=-1, omega_max=1), "`v_max`"),
        (lambda: pr.tracking.ParticleFilter(room, (1, 1), **LIMITS), "`start`"),
        (
            lambda: pr.tracking.ParticleFilter(room, params={"particles": 0}, **LIMITS),
            "`particles`",
        ),
        (lambda: belief.update(0.0), "`dt`"),
        (lambda: belief.update(0.05, (1, math.nan)), "`position`"),
        (lambda: belief.update(0.05, (1, 1), sigma=-1), "`sigma`"),
        (lambda: belief.update(0.05, (1, 1), heading=math.inf), "`heading`"),
        (lambda: belief.update(0.05, observers=[(1, 1)]), "`observers`"),
        (lambda: belief.update(0.05, sensor={"range": -1}), "`range`"),
        (lambda: pr.tracking.visibility(room, [(1, 1, 0)], [(1, 1, 1)]), "`points`"),
    ]:
        with pytest.raises(pr.InvalidInput, match=text):
            call()
