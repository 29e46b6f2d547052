"""Intervals and tests against published values and tables."""

import math
import random

import numpy as np
import pytest

pytest.importorskip("scipy")

from protean_robotics.lab import words
from protean_robotics.lab.statistics import (
    Z95,
    Bracket,
    Crossings,
    Difference,
    Interval,
    Mean,
    Sample,
    difference_of_differences,
    fisher_exact,
    holm,
    mcnemar_exact,
    newcombe,
    quantile,
    simultaneous_z,
    wilson,
    wilson_at,
)


def share(hits: int, of: int) -> tuple[float, Interval]:
    return hits / of, wilson(hits, of)


@pytest.mark.parametrize(
    ("hits", "of", "low", "high"),
    # R. G. Newcombe, *Two-sided confidence intervals for the single proportion*, Stat. Med. 17 (1998), table I, method 3.
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)],
)
def test_wilsons_interval_is_that_of_the_published_examples(hits: int, of: int, low: float, high: float) -> None:
    assert wilson(hits, of) == pytest.approx((low, high), abs=5e-5)


def test_without_data_the_interval_is_0_to_1() -> None:
    for interval in (wilson(0, 0), wilson_at(0.5, math.nan, Z95), wilson_at(math.nan, 10, Z95)):
        assert interval == (0.0, 1.0)
    assert wilson(20, 10) == wilson(10, 10)


def test_means_have_the_quantiles_of_the_tables() -> None:
    mean = Mean.of([1.0, 2.0, 3.0, 4.0])
    assert mean is not None
    # s = 1.29099, t with 3 degrees of freedom 3.18245: 2.5 ± 3.18245 s √(1/4) and √(1 + 1/4).
    assert (mean.count, mean.value, mean.error) == (4, 2.5, pytest.approx(0.645_497_22, abs=1e-8))
    assert mean.interval() == pytest.approx((2.5 - 2.054_260_2, 2.5 + 2.054_260_2), abs=1e-5)
    assert mean.prediction() == pytest.approx((2.5 - 4.593_471, 2.5 + 4.593_471), abs=1e-4)
    one = Mean.of([7.0])
    assert one is not None and one.interval() == one.prediction() == (-math.inf, math.inf)
    assert Mean.of([]) is None and Mean.of([1.0, math.nan]) is None


def test_the_effective_size_of_games_lies_between_games_and_evaders() -> None:
    # Both evaders of a game always have the same outcome: as many outcomes as games, less one degree of freedom.
    dependent = Sample.of([(2, 2)] * 30 + [(0, 2)] * 70)
    assert dependent.effective_size() == pytest.approx(99.0)
    assert dependent.interval().low == pytest.approx(wilson(30, 100).low, abs=1e-3)
    # One of two evaders escapes in every game: the share does not vary between games.
    assert Sample.of([(1, 2)] * 50).interval() == wilson(50, 100)
    # All outcomes are equal: each game counts once.
    assert Sample.of([(0, 2)] * 40).interval() == wilson(0, 40)
    none = Sample.of([(0, 0), (5, 0)])
    assert (none.share, none.effective_size(), none.interval()) == (None, 0.0, (0.0, 1.0))
    assert Sample.of([(7, 2)]).games == ((2, 2),)


@pytest.mark.parametrize(
    ("ours", "theirs", "p", "digits"),
    [
        ((7, 10), (5, 10), 0.65, 0.005),
        ((2, 10), (8, 10), 0.023, 0.0005),
        ((1, 40), (19, 40), 3e-6, 0.5e-6),
        ((4, 30), (17, 30), 0.0009, 0.00005),
        # The lady tasting tea: 3 of 4 cups right.
        ((3, 4), (1, 4), 34 / 70, 1e-12),
        ((0, 10), (0, 20), 1.0, 1e-12),
        ((0, 0), (3, 10), 1.0, 0.0),
    ],
)
def test_fishers_exact_test_has_the_published_p_values(
    ours: tuple[int, int], theirs: tuple[int, int], p: float, digits: float
) -> None:
    assert fisher_exact(ours, theirs) == pytest.approx(p, abs=digits)
    assert fisher_exact(theirs, ours) == pytest.approx(p, abs=digits)


def test_mcnemars_exact_test_is_that_of_a_fair_coin() -> None:
    # By hand: 2 · (1 + 10) / 2¹⁰, 2 / 2⁵, 2 · (1 + 14 + 91) / 2¹⁴.
    for pair, p in [((1, 9), 22 / 1024), ((0, 5), 2 / 32), ((12, 2), 212 / 16384), ((3, 3), 1), ((0, 0), 1), ((1, 0), 1)]:
        assert mcnemar_exact(*pair) == pytest.approx(p, abs=1e-12) == mcnemar_exact(*reversed(pair))


def test_holms_correction_keeps_the_order() -> None:
    # By hand: 4 · 0.005, 3 · 0.01, 2 · 0.03, and 0.04 not below the one before.
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.2]) == [0.2] and holm([]) == []


def test_simultaneous_intervals_are_wider() -> None:
    assert simultaneous_z(1) == pytest.approx(Z95, abs=1e-12)
    assert simultaneous_z(8) == pytest.approx(2.734_368_786_533_1, abs=1e-9)


@pytest.mark.parametrize(
    ("a", "b", "interval"),
    # Table II of the source on independent samples, method 10.
    [
        ((56, 70), (48, 80), (0.0524, 0.3339)),
        ((9, 10), (3, 10), (0.1705, 0.8090)),
        ((6, 7), (2, 7), (0.0582, 0.8062)),
        ((0, 10), (0, 20), (-0.1611, 0.2775)),
    ],
)
def test_newcombes_interval_is_that_of_the_source(
    a: tuple[int, int], b: tuple[int, int], interval: tuple[float, float]
) -> None:
    assert newcombe(share(*a), share(*b), 0.0) == pytest.approx(interval, abs=1e-4)


def test_a_correlation_narrows_newcombes_interval() -> None:
    # 50 pairs: 20 hits on both sides, 12 on the first, 2 on the second, 16 on none. By hand:
    # φ = (20 · 16 − 12 · 2) / √(32 · 18 · 22 · 28) = 0.4969; 32/50: 0.5014 … 0.7586; 22/50: 0.3116 … 0.5769.
    expected = pytest.approx((0.0618, 0.3242), abs=1e-4)
    phi = 296 / math.sqrt(32 * 18 * 22 * 28)
    assert newcombe(share(32, 50), share(22, 50), phi) == expected
    pairs = [(1, 1)] * 20 + [(1, 0)] * 12 + [(0, 1)] * 2 + [(0, 0)] * 16
    first, second = ({seed: (pair[side], 1) for seed, pair in enumerate(pairs)} for side in (0, 1))
    difference = Difference.of(first, second)
    assert difference is not None and difference.larger == (12, 2)
    assert difference.value == pytest.approx(0.2) and difference.p_value == pytest.approx(212 / 16384)
    # The effective size is that of 49 independent pairs.
    assert difference.interval() == pytest.approx((0.0618, 0.3242), abs=2e-3)
    assert Difference.of(first, {99: (1, 1)}) is None


def test_differences_are_over_the_seeds_that_both_cells_have() -> None:
    def cell(*hits: int) -> dict[int, tuple[int, int]]:
        return {seed: (hit, 2) for seed, hit in enumerate(hits, 1)}

    a, b, c, d = cell(2, 2, 1), cell(0, 1, 1, 2), cell(1, 0, 2), cell(1, 0, 0)
    # By seed: 1 − 0, ½ − 0, 0 − 1.
    mean = difference_of_differences((a, b, c, d))
    assert mean is not None and mean.value == pytest.approx(0.5 / 3)
    assert difference_of_differences((a, b, c, {})) is None
    difference, back = Difference.of(a, b), Difference.of(b, a)
    assert difference is not None and back is not None
    assert difference.value == pytest.approx(0.5) == -back.value and difference.larger == (2, 0)
    assert difference.interval().contains(difference.value)


def crossings(counts: dict[float, int], of: int = 100) -> Crossings:
    found = Crossings.of((x, hits / of, wilson(hits, of)) for x, hits in counts.items())
    assert found is not None
    return found


def test_brackets_are_neighbours_and_the_range_leaves_out_what_is_sure() -> None:
    found = crossings({1.0: 10, 1.5: 45, 1.25: 12, 2.0: 55, 3.0: 90})
    assert found == Crossings([Bracket(1.5, 2.0, True)], Interval(1.25, 3.0))
    found = crossings({1.45: 100, 1.0: 0, 1.8: 26, 2.25: 73})
    assert found.brackets == [(1.0, 1.45, True), (1.45, 1.8, False), (1.8, 2.25, True)]
    assert found.range == (1.0, 2.25)
    assert crossings({1.0: 0, 2.0: 3}) == Crossings([], Interval(2.0, math.inf))
    assert crossings({1.0: 100, 2.0: 100}) == Crossings([], Interval(-math.inf, 1.0))
    assert crossings({1.0: 45, 2.0: 55}).range == (-math.inf, math.inf)
    assert Crossings.of([]) is None


def test_every_interval_and_bracket_holds_for_random_counts() -> None:
    rng = random.Random(1)
    for _ in range(200):
        n = rng.randint(1, 300)
        hits = rng.randint(0, n)
        interval, mirror = wilson(hits, n), wilson(n - hits, n)
        assert interval.contains(hits / n)
        assert interval.low + mirror.high == pytest.approx(1.0)
        games = Sample.of((rng.randint(0, m), m) for m in (rng.randint(1, 5) for _ in range(rng.randint(1, 60))))
        assert games.share is not None and games.interval().contains(games.share)
        assert games.interval().width >= wilson(games.hits, games.members).width - 1e-12
        found = crossings({float(x): rng.randint(0, 60) for x in range(rng.randint(1, 7))}, 60)
        assert all(found.range.low <= low and high <= found.range.high for low, high, _ in found.brackets)
        values = [rng.uniform(-1, 1) for _ in range(n)]
        for part in (0.0, 0.05, 0.5, 0.95, 1.0, rng.random()):
            assert quantile(values, part) == pytest.approx(float(np.quantile(values, part)))
    assert quantile([], 0.5) is None


def test_numbers_have_their_texts() -> None:
    assert words.share(0.635) == "63.5 %"
    assert words.shares(Interval(0.0, 0.2775)) == "0.0 … 27.8 %"
    assert words.percent(0.64, Interval(0.58, 0.69)) == "64 % (58 … 69)"
    assert [words.points(v) for v in (0.125, -0.03, 0.0, -1e-9)] == ["+12.5", "−3.0", "0.0", "0.0"]
    assert [words.p_value(p) for p in (0.65, 0.0009, 3e-6)] == ["p = 0.65", "p = 0.0009", "p < 0.0001"]
    assert [words.ratio(v) for v in (1.5, 2.0, 0.85)] == ["1.5×", "2.0×", "0.85×"]
    assert words.ratios([0.8, 0.9, 1.0]) == "0.8×, 0.9× and 1.0×"
    assert [words.ratios([2.0]), words.ratios([])] == ["2.0×", ""]
    ends = [(1.0, 2.0), (1.0, math.inf), (-math.inf, 2.0), (-math.inf, math.inf)]
    texts = ["1.0× … 2.0×", "above 1.0×", "below 2.0×", "open"]
    assert [words.ratio_range(Interval(*end)) for end in ends] == texts
    assert words.in_table("a|b\nc") == "a\\|b c"
