"""Intervals and tests for shares and means.

Outcomes of the evaders of one game are not independent: a pursuer that chases one evader lets another one escape. A
`Sample` therefore keeps outcomes by game. Cells played on the same seeds are compared seed by seed (`Difference`).
Sums are exact or over whole numbers, so that the order of results does not matter.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from .._optional import imported

#: Hits and members of the game of every seed.
BySeed = Mapping[int, tuple[int, int]]

#: Number of standard errors to either side that contain 95 % of a normal distribution.
Z95 = 1.959963984540054


class Interval(NamedTuple):
    """A closed interval."""

    low: float
    high: float

    def contains(self, value: float) -> bool:
        """True if the value is inside."""
        return self.low <= value <= self.high

    def is_within(self, other: "Interval") -> bool:
        """True if it lies within another one."""
        return other.low <= self.low and self.high <= other.high

    @property
    def width(self) -> float:
        """Width."""
        return self.high - self.low


def wilson(hits: int, of: int) -> Interval:
    """Wilson's 95 % interval for the probability, given hits of independent outcomes.

    0 to 1 without outcomes. Source: E. B. Wilson, *Probable inference, the law of succession, and statistical inference*,
    J. Am. Stat. Assoc. 22 (1927).
    """
    return wilson_at(min(hits, of) / max(of, 1), of, Z95)


def wilson_at(share: float, n: float, z: float) -> Interval:
    """The same for a share of ``n`` outcomes, which need not be whole, ``z`` standard errors to either side."""
    if not n > 0.0 or not math.isfinite(share) or not math.isfinite(z):
        return Interval(0.0, 1.0)
    zz = z * z / n
    centre = (share + zz / 2.0) / (1.0 + zz)
    half = math.sqrt(share * (1.0 - share) * zz + zz * zz / 4.0) / (1.0 + zz)
    # The bounds are exact at 0 and 1, without rounding errors, and never exclude the share.
    low = 0.0 if share <= 0.0 else centre - half
    high = 1.0 if share >= 1.0 else centre + half
    return Interval(min(max(low, 0.0), share), max(min(high, 1.0), share))


@dataclass(frozen=True)
class Mean:
    """Mean of independent values.

    Attributes
    ----------
    count
        Number of values.
    value
        Mean.
    error
        Standard error of the mean; infinite for a single value.
    """

    count: int
    value: float
    error: float

    @staticmethod
    def of(values: Iterable[float]) -> "Mean | None":
        """Mean of values; None without values, or if one is not finite."""
        values = list(values)
        if not values or not all(map(math.isfinite, values)):
            return None
        n = len(values)
        value = math.fsum(values) / n
        squares = math.fsum((v - value) ** 2 for v in values)
        return Mean(n, value, math.sqrt(squares / (n - 1) / n) if n > 1 else math.inf)

    def interval(self) -> Interval:
        """95 % confidence interval (Student's t); unbounded for a single value."""
        return self._around(1.0)

    def prediction(self) -> Interval:
        """95 % prediction interval for one more value like these (Student's t, values normally distributed)."""
        return self._around(math.sqrt(self.count + 1.0))

    def _around(self, widening: float) -> Interval:
        half = math.inf
        if self.count > 1:
            half = float(imported("scipy.special").stdtrit(self.count - 1, 0.975)) * self.error * widening
        return Interval(self.value - half, self.value + half)


@dataclass(frozen=True)
class Sample:
    """Outcomes in groups, such as the escapes among the evaders of each game; groups are independent.

    Attributes
    ----------
    games
        Hits and members of each group that has members.
    """

    games: tuple[tuple[int, int], ...]

    @staticmethod
    def of(games: Iterable[tuple[int, int]]) -> "Sample":
        """Groups given as hits and members; more hits than members count as the members."""
        return Sample(tuple((min(hits, members), members) for hits, members in games if members > 0))

    @property
    def groups(self) -> int:
        """Number of groups."""
        return len(self.games)

    @property
    def hits(self) -> int:
        """Number of hits."""
        return sum(hits for hits, _ in self.games)

    @property
    def members(self) -> int:
        """Number of members of all groups."""
        return sum(members for _, members in self.games)

    @property
    def share(self) -> float | None:
        """Share of hits among all members; None without members."""
        return self.hits / self.members if self.games else None

    def effective_size(self) -> float:
        """Number of independent outcomes with the same information, at most the members.

        The members by the design effect, the ratio of the variance of the share between groups (linearised ratio
        estimator) to that of independent outcomes. If all outcomes are equal, each group counts as one outcome.

        Sources: W. G. Cochran, *Sampling Techniques*, §9A.1, §11.8; J. N. K. Rao and A. J. Scott, *A simple method for
        the analysis of clustered binary data*, Biometrics 48 (1992); the bound by the members: E. L. Korn and B. I.
        Graubard, Surv. Methodol. 24 (1998).
        """
        share = self.share
        if share is None:
            return 0.0
        members, groups = float(self.members), float(self.groups)
        squared = float(sum(m * m for _, m in self.games))
        independent = share * (1.0 - share)
        if independent <= 0.0 or groups < 2:
            # Each group counts as one outcome, weighted by its members (Kish).
            return members * members / squared
        hits, products = sum(h * h for h, _ in self.games), sum(h * m for h, m in self.games)
        squares = hits - 2.0 * share * products + share * share * squared
        between = max(squares, 0.0) / members * groups / (groups - 1.0)
        return members / max(between / independent, 1.0)

    def interval(self, z: float = Z95) -> Interval:
        """Interval of the share, ``z`` standard errors to either side: Wilson's with the effective size.

        Source: C. Franco et al., *Comparative study of confidence intervals for proportions in complex sample surveys*,
        J. Surv. Stat. Methodol. 7 (2019).
        """
        share = self.share
        return wilson_at(0.5 if share is None else share, self.effective_size(), z)


def fisher_exact(ours: tuple[int, int], theirs: tuple[int, int]) -> float:
    """Two-sided p-value that hits of independent outcomes, twice, have the same chance; 1 without outcomes.

    Source: R. A. Fisher, *Statistical Methods for Research Workers*, §21.02; two-sided by summing the improbable tables.
    """
    if not ours[1] or not theirs[1]:
        return 1.0
    table = [[min(hits, of), of - min(hits, of)] for hits, of in (ours, theirs)]
    return float(imported("scipy.stats").fisher_exact(table).pvalue)


def mcnemar_exact(first: int, second: int) -> float:
    """Two-sided p-value that pairs which differ favour either side with the same chance; 1 if no pair differs.

    Source: Q. McNemar, *Note on the sampling error of the difference between correlated proportions or percentages*,
    Psychometrika 12 (1947); exact by the binomial distribution (sign test).
    """
    if not first + second:
        return 1.0
    return float(imported("scipy.stats").binomtest(min(first, second), first + second).pvalue)


def holm(p_values: Sequence[float]) -> list[float]:
    """Holm's correction: adjusts p-values so that the chance of any false one among those below 5 % is below 5 %.

    Source: S. Holm, *A simple sequentially rejective multiple test procedure*, Scand. J. Stat. 6 (1979).
    """
    adjusted, largest = list(p_values), 0.0
    for rank, index in enumerate(sorted(range(len(adjusted)), key=p_values.__getitem__)):
        largest = min(max(largest, p_values[index] * (len(adjusted) - rank)), 1.0)
        adjusted[index] = largest
    return adjusted


def simultaneous_z(count: int) -> float:
    """Standard errors to either side for each of several intervals that hold together with 95 % (Bonferroni)."""
    return float(-imported("scipy.special").ndtri(0.025 / max(count, 1)))


def newcombe(first: tuple[float, Interval], second: tuple[float, Interval], correlation: float) -> Interval:
    """Interval of a difference of two shares with their Wilson intervals, measured on the same cases.

    ``correlation`` is that of their outcomes; 0 for independent samples. Sources: R. G. Newcombe, *Improved confidence
    intervals for the difference between binomial proportions based on paired data*, Stat. Med. 17 (1998), method 8; for
    independent samples the same author's *Interval estimation for the difference between independent proportions*, ibid.,
    method 10.
    """
    (p, of_p), (q, of_q) = first, second

    def side(a: float, b: float) -> float:
        return math.sqrt(max(a * a - 2.0 * correlation * a * b + b * b, 0.0))

    down = side(p - of_p.low, of_q.high - q)
    up = side(of_p.high - p, q - of_q.low)
    return Interval(max(p - q - down, -1.0), min(p - q + up, 1.0))


def _share(game: tuple[int, int]) -> float:
    return game[0] / max(game[1], 1)


def _correlation(pairs: Sequence[tuple[float, float]]) -> float:
    """Pearson's correlation; 0 if one side does not vary."""
    n = len(pairs)
    x, y = (math.fsum(pair[side] for pair in pairs) / n for side in (0, 1))
    xx = math.fsum((a - x) ** 2 for a, _ in pairs)
    yy = math.fsum((b - y) ** 2 for _, b in pairs)
    xy = math.fsum((a - x) * (b - y) for a, b in pairs)
    return min(max(xy / math.sqrt(xx * yy), -1.0), 1.0) if xx > 0.0 and yy > 0.0 else 0.0


@dataclass(frozen=True)
class Difference:
    """Difference of the shares of two cells, over the seeds that both have.

    Attributes
    ----------
    value
        Share of the first less share of the second.
    larger
        Number of seeds whose game has the larger share in the first cell, and in the second.
    p_value
        That both numbers have the same chance: McNemar's exact test by game.
    """

    value: float
    larger: tuple[int, int]
    p_value: float
    _sides: tuple[tuple[float, float], tuple[float, float]]
    _correlation: float

    @staticmethod
    def of(first: BySeed, second: BySeed) -> "Difference | None":
        """Compares two cells; None without a common seed."""
        seeds = sorted(seed for seed in first.keys() & second.keys() if first[seed][1] and second[seed][1])
        if not seeds:
            return None
        a, b = (Sample.of(cell[seed] for seed in seeds) for cell in (first, second))
        assert a.share is not None and b.share is not None
        pairs = [(_share(first[seed]), _share(second[seed])) for seed in seeds]
        larger = sum(x > y for x, y in pairs), sum(y > x for x, y in pairs)
        sides = (a.share, a.effective_size()), (b.share, b.effective_size())
        return Difference(a.share - b.share, larger, mcnemar_exact(*larger), sides, _correlation(pairs))

    def interval(self, z: float = Z95) -> Interval:
        """Newcombe's interval, ``z`` standard errors to either side, with outcomes counted by effective sizes."""
        first, second = ((share, wilson_at(share, n, z)) for share, n in self._sides)
        return newcombe(first, second, self._correlation)


def difference_of_differences(cells: tuple[BySeed, BySeed, BySeed, BySeed]) -> Mean | None:
    """Mean over the common seeds of (first − second) − (third − fourth) of the shares."""
    first, second, third, fourth = cells
    seeds = first.keys() & second.keys() & third.keys() & fourth.keys()
    return Mean.of(
        _share(first[seed]) - _share(second[seed]) - _share(third[seed]) + _share(fourth[seed]) for seed in seeds
    )


class Bracket(NamedTuple):
    """Two neighbouring measured values between which a chance crosses one half."""

    low: float
    high: float
    rises: bool


@dataclass(frozen=True)
class Crossings:
    """Values of a quantity at which measured chances cross one half, without interpolation.

    Attributes
    ----------
    brackets
        Ascending; empty if the chance never crosses one half.
    range
        Range outside which the intervals exclude a crossing: from the last value up to which all intervals lie below one
        half (−∞ if the first does not) to the first value from which all lie above it (∞ if the last does not).
    """

    brackets: list[Bracket]
    range: Interval

    @staticmethod
    def of(points: Iterable[tuple[float, float, Interval]]) -> "Crossings | None":
        """Crossings of points (value of the quantity, chance, its interval) in any order; None without points."""
        points = sorted(points)
        if not points:
            return None
        brackets = [
            Bracket(a[0], b[0], b[1] >= 0.5)
            for a, b in zip(points, points[1:], strict=False)
            if (a[1] >= 0.5) != (b[1] >= 0.5)
        ]
        low, high = -math.inf, math.inf
        for x, _, interval in points:
            if interval.high >= 0.5:
                break
            low = x
        for x, _, interval in reversed(points):
            if interval.low <= 0.5:
                break
            high = x
        return Crossings(brackets, Interval(low, high))


def quantile(values: Iterable[float], share: float) -> float | None:
    """Quantile of a share (0 to 1), linear between the two neighbours, as NumPy's; None without values.

    The value at place ``share * (n - 1)`` of the ascending values, from 0: the median of an even number is the mean of the
    middle two. Source: R. J. Hyndman and Y. Fan, *Sample quantiles in statistical packages*, Am. Stat. 50 (1996), definition 7.
    """
    ascending = sorted(values)
    if not ascending:
        return None
    part, place = math.modf(share * (len(ascending) - 1))
    low, high = ascending[int(place)], ascending[min(int(place) + 1, len(ascending) - 1)]
    return low + part * (high - low) if part else low
