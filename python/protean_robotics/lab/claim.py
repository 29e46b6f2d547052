"""Published statements and numbers, and what our results say about them, as data."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from enum import Enum, StrEnum
from typing import Any

from . import words
from .statistics import Interval, Mean, wilson


class Paper(StrEnum):
    """One of the papers, or the targets of this project, by its key, in the order of reports."""

    CHASE = "chase"
    PATROL = "patrol"
    COVERAGE = "coverage"
    VMC_LP = "vmc-lp"
    TEAMS = "teams"

    @property
    def full_title(self) -> str:
        """Title of the paper."""
        return {
            Paper.CHASE: "Multi-robot navigation in the context of a chasing game",
            Paper.PATROL: "Cat-map patrol paper",
            Paper.COVERAGE: "Chebyshev coverage paper",
            Paper.VMC_LP: "Report on virtual motion camouflage and local pursuit",
            Paper.TEAMS: "Patrols of teams: targets of this project",
        }[self]


class Verdict(StrEnum):
    """Verdict on a claim, in the order of reports."""

    CONFIRMED = "confirmed"
    REFUTED = "refuted"
    UNDECIDED = "undecided"
    NO_DATA = "no_data"

    @property
    def word(self) -> str:
        """Plain word."""
        return self.value.replace("_", " ")

    @property
    def markdown(self) -> str:
        """Text of the pages."""
        decided = self in (Verdict.CONFIRMED, Verdict.REFUTED)
        return f"**{self.word}**" if decided else self.word

    @staticmethod
    def above(interval: Interval, limit: float) -> "Verdict":
        """Verdict on the claim that a number lies above a limit."""
        if interval.low > limit:
            return Verdict.CONFIRMED
        return Verdict.REFUTED if interval.high < limit else Verdict.UNDECIDED

    @staticmethod
    def below(interval: Interval, limit: float) -> "Verdict":
        """Verdict on the claim that a number lies below a limit."""
        return Verdict.above(Interval(-interval.high, -interval.low), -limit)


class _Form(Enum):
    SHARE = "share"
    POINTS = "difference of shares"
    SPEED = "speed of the Police"
    NUMBER = ""


@dataclass(frozen=True)
class Unit:
    """Unit of a number and of its interval.

    Attributes
    ----------
    name
        Name in the data; empty for plain numbers.
    digits
        Digits after the point of a plain number.
    """

    name: str
    digits: int = 0
    form: _Form = _Form.NUMBER

    def value(self, value: float) -> str:
        """Text of a value."""
        match self.form:
            case _Form.SHARE:
                return words.share(value)
            case _Form.POINTS:
                return f"{words.points(value)} points"
            case _Form.SPEED:
                return words.ratio(value)
        return f"{words.decimals(value, self.digits)} {self.name}".rstrip()

    def interval(self, interval: Interval) -> str:
        """Text of an interval."""
        match self.form:
            case _Form.SHARE:
                return words.shares(interval)
            case _Form.POINTS:
                return words.point_range(interval)
            case _Form.SPEED:
                return words.ratio_range(interval)
        if not math.isfinite(interval.width):
            return "open"
        return f"{words.decimals(interval.low, self.digits)} … {words.decimals(interval.high, self.digits)}"


#: A share, 0 to 1; text in percent.
SHARE = Unit(_Form.SHARE.value, form=_Form.SHARE)
#: A difference of shares, −1 to 1; text in points.
POINTS = Unit(_Form.POINTS.value, form=_Form.POINTS)
#: A speed relative to the Police.
SPEED = Unit(_Form.SPEED.value, form=_Form.SPEED)


def number(digits: int, unit: str = "") -> Unit:
    """A number with its unit, written with these digits after the point."""
    return Unit(unit, digits)


@dataclass(frozen=True)
class Published:
    """A published statement or number: its text, and the number if it is one."""

    text: str
    value: float | None = None

    @staticmethod
    def number(value: float, unit: Unit) -> "Published":
        """A published number."""
        return Published(unit.value(value), value)


@dataclass(frozen=True)
class Measured:
    """Result of ours for a claim.

    Attributes
    ----------
    text
        The number, or the text for it.
    value
        The number, if it is one.
    interval
        The interval that decides, mostly of 95 %; the rule of the claim says of what.
    unit
        Unit of number and interval.
    n
        Number of observations.
    of
        Plural of the observed things.
    """

    text: str = "–"
    value: float | None = None
    interval: Interval | None = None
    unit: Unit = field(default_factory=lambda: number(0))
    n: int = 0
    of: str = "results"

    @staticmethod
    def number(value: float, interval: Interval, unit: Unit, n: int, of: str) -> "Measured":
        """A number with its interval."""
        return Measured(unit.value(value), value, interval, unit, n, of)

    @staticmethod
    def computed(value: float, unit: Unit, of: str = "computation") -> "Measured":
        """A number without an interval: it is computed, not sampled."""
        return Measured(unit.value(value), value, None, unit, 1, of)

    @staticmethod
    def share(hits: int, of: int, what: str) -> "Measured":
        """A count as a share with Wilson's interval; the mark of a missing number without observations."""
        if not of:
            return Measured()
        return replace(Measured.number(hits / of, wilson(hits, of), SHARE, of, what), text=f"{hits}/{of}")

    @property
    def interval_text(self) -> str:
        """Text of the interval; ``–`` without one."""
        return "–" if self.interval is None else self.unit.interval(self.interval)

    def data(self) -> dict[str, Any]:
        """As data; an open end is null."""
        ends = self.interval and [end if math.isfinite(end) else None for end in self.interval]
        return {
            "text": self.text,
            "value": self.value,
            "unit": self.unit.name,
            "interval": ends,
            "interval_text": self.interval_text,
            "n": self.n,
            "of": self.of,
        }


@dataclass(frozen=True)
class Finding:
    """A verdict, the number that it rests on, and further numbers, a line each."""

    verdict: Verdict
    ours: Measured
    numbers: list[str] = field(default_factory=list)

    @staticmethod
    def missing(what: str) -> "Finding":
        """A finding without data."""
        return Finding(Verdict.NO_DATA, Measured(), [f"There are no results for this: {what}."])

    @staticmethod
    def one_run(published: float, values: Sequence[float], unit: Unit, of: str) -> "Finding":
        """Compares a published value of one run with several runs of ours: `ONE_RUN`."""
        mean = Mean.of(values)
        if mean is None:
            return Finding.missing("a value of a run")
        interval = mean.prediction()
        verdict = Verdict.CONFIRMED if mean.count >= _MIN_RUNS else Verdict.UNDECIDED
        if not interval.contains(published):
            verdict = Verdict.REFUTED
        return Finding(verdict, Measured.number(mean.value, interval, unit, mean.count, of))

    @staticmethod
    def exact(published: float, ours: float, unit: Unit) -> "Finding":
        """Compares a published value with a computed one, at the digits of its unit: `EXACT`."""
        same = unit.value(published) == unit.value(ours)
        return Finding(Verdict.CONFIRMED if same else Verdict.REFUTED, Measured.computed(ours, unit))


#: Minimum number of runs that confirm a value.
_MIN_RUNS = 5
#: Rule of `Finding.one_run`.
ONE_RUN = (
    "The published value is one run under one key: refuted if it lies outside our 95 % prediction interval for one more"
    " run, confirmed if inside that of five runs or more."
)
#: Rule of `Finding.exact`.
EXACT = "Computed: confirmed if it rounds to the published digits, refuted if not."


@dataclass(frozen=True)
class Claim:
    """A claim with its verdict.

    Attributes
    ----------
    paper
        The paper.
    key
        Key of the claim, unique within the paper.
    text
        Statement, with its place in the paper.
    published
        The published statement or number.
    rule
        Rule of the verdict, and meaning of the interval.
    finding
        Verdict and numbers of ours.
    timed
        True if it compares times of this machine, which differ between runs.
    """

    paper: Paper
    key: str
    text: str
    published: Published
    rule: str
    finding: Finding
    timed: bool = False

    @property
    def id(self) -> str:
        """Key, unique among all claims."""
        return f"{self.paper}.{self.key}"

    @property
    def ours(self) -> Measured:
        """The number of ours that decides."""
        return self.finding.ours

    @property
    def verdict(self) -> Verdict:
        """Verdict by the rule."""
        return self.finding.verdict

    def data(self) -> dict[str, Any]:
        """As data."""
        return {
            "paper": self.paper.value,
            "id": self.id,
            "claim": self.text,
            "published": asdict(self.published),
            "ours": self.ours.data(),
            "verdict": self.verdict.value,
            "rule": self.rule,
            "details": self.finding.numbers,
            "timed": self.timed,
        }
