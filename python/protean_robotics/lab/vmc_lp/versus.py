"""Tables 3 and 4: local pursuit against motion camouflage."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from .. import words
from ..claim import Verdict
from ..figures import Chart, Point, Series
from ..statistics import fisher_exact, quantile, wilson
from .evidence import TABLE_3, TABLE_4_FIRST, TABLE_4_SECOND, Study, Test, share

#: Relative difference of times, by the smaller one, below which they are equal.
_SAME = 1e-4
#: Relative difference of times, by the smaller one, from which it matters in practice.
_NOTABLE = 1e-2
#: Values of the experiment's parameter, their titles, and the published tests.
_HORIZONS: tuple[tuple[str, str, Sequence[Test]], ...] = (
    ("only", "one horizon, 5 obstacles (Table 3)", TABLE_3),
    ("first", "first planning, 3 obstacles (Table 4)", TABLE_4_FIRST),
    ("second", "second planning, 2 more (Table 4)", TABLE_4_SECOND),
)


class Pair(NamedTuple):
    """A pair of cases: LP and VMC, the name of its slots, and its name in the chart."""

    lp: str
    vmc: str
    slot: str
    title: str


#: Pairs of cases that are compared.
PAIRS = (
    Pair("lp", "vmc", "recommended", "As recommended here"),
    Pair("lp_paper", "vmc_paper", "as_published", "8 control points, degree 4, 15 nodes, nothing to fall back on"),
)


@dataclass
class _Duel:
    """Problems that both methods solved, with their times.

    Attributes
    ----------
    solvable
        Problems with a solution.
    solved
        Number of these that LP, and VMC, solved.
    times
        Driving times (s) of problems that both solved: LP, VMC.
    cpu
        CPU times: LP, VMC.
    """

    solvable: int = 0
    solved: tuple[int, int] = (0, 0)
    times: list[tuple[float, float]] = field(default_factory=list)
    cpu: list[tuple[float, float]] = field(default_factory=list)

    @staticmethod
    def published(tests: Sequence[Test]) -> "_Duel":
        n = len(tests)
        return _Duel(n, (n, n), [test.time for test in tests], [test.cpu for test in tests])

    @staticmethod
    def of(study: Study, pair: Pair, horizon: str) -> "_Duel | None":
        lp, vmc = (study.cells.get((case, horizon)) for case in pair[:2])
        if lp is None or vmc is None:
            return None
        both = [(lp[seed], vmc[seed]) for seed in lp if seed in vmc]
        both = [(a, b) for a, b in both if not a.unsolvable and not b.unsolvable]
        solved = sum(a.time is not None for a, _ in both), sum(b.time is not None for _, b in both)
        duel = _Duel(len(both), solved)
        for a, b in both:
            if a.time is not None and b.time is not None:
                duel.times.append((a.time, b.time))
                if a.cpu_ms is not None and b.cpu_ms is not None:
                    duel.cpu.append((a.cpu_ms, b.cpu_ms))
        return duel

    @property
    def differences(self) -> list[float]:
        """VMC's time less LP's, relative to the smaller one."""
        return [(b - a) / min(a, b) for a, b in self.times]

    @property
    def shorter(self) -> tuple[int, int]:
        """Pairs in which LP's plan is shorter, of those that differ."""
        differ = [d for d in self.differences if abs(d) > _SAME]
        return sum(d > 0.0 for d in differ), len(differ)

    @property
    def notable(self) -> tuple[int, int]:
        """Pairs whose times differ notably."""
        return sum(abs(d) > _NOTABLE for d in self.differences), len(self.times)

    @property
    def quicker(self) -> tuple[int, int]:
        """Pairs in which LP needs less CPU time."""
        return sum(a < b for a, b in self.cpu), len(self.cpu)

    @property
    def ratios(self) -> list[float]:
        """VMC's CPU times by LP's."""
        return [b / a for a, b in self.cpu]


def _median(values: Iterable[float], digits: int) -> str:
    found = quantile(values, 0.5)
    return "–" if found is None else f"{found:.{digits}f}"


def _count(count: tuple[int, int]) -> str:
    hits, of = count
    return f"{hits}/{of} ({words.shares(wilson(hits, of))})" if of else "–"


def values(study: Study) -> dict[str, Any]:
    """Tables and findings of the page."""
    return {
        pair.slot: {
            "table": _table(study, pair),
            "findings": "".join(map(str, observations(study, pair))),
        }
        for pair in PAIRS
    }


def _table(study: Study, pair: Pair) -> str:
    text = ""
    for horizon, title, tests in _HORIZONS:
        text += _line(f"{title}, published", _Duel.published(tests), "s")
        duel = _Duel.of(study, pair, horizon)
        if duel is None:
            text += f"| {title}, **ours** | no results | | | | | | | |\n"
        else:
            text += _line(f"{title}, **ours**", duel, "ms")
    return text


def _line(title: str, duel: _Duel, unit: str) -> str:
    def medians(pairs: Sequence[tuple[float, float]]) -> str:
        return ", ".join(_median((pair[side] for pair in pairs), 2) for side in (0, 1))

    def size(part: float) -> str:
        found = quantile(map(abs, duel.differences), part)
        return "–" if found is None else f"{100.0 * found:.3f} %"

    columns = (
        title,
        f"{duel.solved[0]}, {duel.solved[1]} of {duel.solvable}",
        medians(duel.times),
        _count(duel.shorter),
        _count(duel.notable),
        f"{size(0.5)}, {size(1.0)}",
        _count(duel.quicker),
        f"{medians(duel.cpu)} {unit}",
        _median(duel.ratios, 2),
    )
    return f"| {' | '.join(columns)} |\n"


@dataclass(frozen=True)
class Observation:
    """An observation of the report, on all horizons together.

    Attributes
    ----------
    key
        Its key.
    claim
        Statement.
    ours, published
        Our counts and the published ones: hits, pairs.
    verdict, words
        Verdict and its text.
    p
        P-value of the comparison of both counts, where it decides.
    timed
        True if CPU times are compared.
    """

    key: str
    claim: str
    ours: tuple[int, int]
    published: tuple[int, int]
    verdict: Verdict
    words: str
    p: float | None = None
    timed: bool = False

    def __str__(self) -> str:
        hits, of = self.published
        theirs = f"{words.share(share(self.published))}, {hits}/{of}"
        if self.p is not None:
            theirs = f"{hits}/{of}; {words.p_value(self.p)}"
        return f"- {self.claim}: {self.words} (ours {_count(self.ours)}; published {theirs}).\n"


def observations(study: Study, pair: Pair) -> list[Observation]:
    """Tests the report's observations."""
    ours, theirs = _Duel(), _Duel()
    for horizon, _, tests in _HORIZONS:
        for all_, duel in ((ours, _Duel.of(study, pair, horizon)), (theirs, _Duel.published(tests))):
            if duel is not None:
                all_.times += duel.times
                all_.cpu += duel.cpu
    pairs = len(ours.times)
    same = pairs - ours.shorter[1]
    # Very few pairs that differ are an answer, too.
    verdict, text = Verdict.REFUTED, f"**contradicted**: {same} of {pairs} pairs are the same within 0.01 %"
    if 20 * ours.shorter[1] >= pairs:
        verdict, text = _more_often(ours.shorter)
    found = [
        Observation(
            "shorter", "LP's plans are shorter more often than VMC's", ours.shorter, theirs.shorter, verdict, text
        ),
        Observation(
            "quicker",
            "LP needs less CPU time more often than VMC",
            ours.quicker,
            theirs.quicker,
            *_more_often(ours.quicker),
            timed=True,
        ),
    ]
    if pairs:
        p = fisher_exact(ours.notable, theirs.notable)
        decided = (Verdict.REFUTED, "**contradicted**") if p < 0.05 else (Verdict.UNDECIDED, "not contradicted")
        claim = "Which method is chosen makes a difference of more than 1 % of the time in most tests"
        found.append(Observation("notable", claim, ours.notable, theirs.notable, *decided, p))
    return found


def _more_often(count: tuple[int, int]) -> tuple[Verdict, str]:
    """Decides whether hits are more often than not."""
    if not count[1]:
        return Verdict.NO_DATA, "no data"
    verdict = Verdict.above(wilson(*count), 0.5)
    texts = {Verdict.CONFIRMED: "confirmed", Verdict.REFUTED: "**contradicted**"}
    return verdict, texts.get(verdict, "not decided")


def chart(study: Study) -> Chart:
    """The chart of Tables 3 and 4: VMC's CPU time relative to LP's."""

    def points(duels: Iterable[_Duel | None]) -> list[Point]:
        found = []
        for x, duel in enumerate(duels):
            median, low, high = (quantile(duel.ratios if duel else (), part) for part in (0.5, 0.05, 0.95))
            if median is not None and low is not None and high is not None:
                found.append(Point(float(x), median, (low, high)))
        return found

    curves = []
    for pair in PAIRS:
        ours = points(_Duel.of(study, pair, horizon) for horizon, _, _ in _HORIZONS)
        theirs = points(_Duel.published(tests) for _, _, tests in _HORIZONS) if pair.lp == "lp" else []
        curves.append(Series(pair.title.replace(", ", ",\n"), ours, theirs))
    return Chart(
        name="vmc-lp-cpu",
        title="CPU time of VMC by that of LP, the same problem",
        subtitle="Median of the problems that both methods solved; bars from the 5th to the 95th percentile."
        f" Seeds {study.seeds}.",
        x_label="planning",
        x_names=["one horizon", "first", "second"],
        y_label="VMC's CPU time by LP's",
        share=False,
        series=curves,
        reference="published (6, 4 and 4 tests)",
    )
