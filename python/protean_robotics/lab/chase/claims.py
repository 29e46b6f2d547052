"""The claims of the chasing-game paper, and their verdicts from our games."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import NamedTuple

from .. import words
from ..claim import POINTS, SHARE, SPEED, Claim, Finding, Measured, Paper, Published, Verdict, number
from ..plans import Plan
from ..statistics import (
    BySeed,
    Difference,
    Interval,
    Mean,
    difference_of_differences,
    holm,
    simultaneous_z,
    wilson,
)
from . import evidence as published
from .evidence import BRAITENBERG, EXACT, FIELD, FILTER, KNOWLEDGE_RATIOS, LINE, SPEED_RATIOS, Cell, Evidence, Study


class Statement(NamedTuple):
    """A statement: its letter on the page, its text, the paper's words for it, and the rule of the verdict."""

    letter: str
    text: str
    published: str
    rule: str


#: All statements, in the order of the page.
_STATEMENTS = (
    Statement(
        "a",
        (
            "At every speed, RRT* evaders escape at least as often as those on a potential field, and these at "
            "least as often as Braitenberg vehicles."
        ),
        "at least as often",
        (
            "Eight comparisons, two at each speed of Fig. 2. Confirmed if every one is higher, or its interval "
            "rules out that it is lower by more than 5 points; refuted if one is lower."
        ),
    ),
    Statement(
        "b",
        (
            "On a potential field, the critical speed, above which half of the evaders escape, is about twice "
            "that of the Police."
        ),
        "about 2.0×",
        (
            "The range by the intervals, as above. Confirmed if all of it lies between 1.75× and 2.25× (half a "
            "step of Fig. 2 to either side); refuted if none of it does."
        ),
    ),
    Statement(
        "c",
        "On a potential field, evaders escape less often when they are faster than twice the Police.",
        "less often",
        (
            "The games at 2.5× and 3.0× together against those at 2.0×. Confirmed if lower; refuted if higher, or "
            "if the interval rules out a drop by more than 5 points."
        ),
    ),
    Statement(
        "d",
        "Braitenberg vehicles have no critical speed: they rarely escape, however fast they are.",
        "rarely",
        (
            "Simultaneous intervals over all speeds. Confirmed if fewer than half escape at every speed; refuted "
            "if more than half escape at one."
        ),
    ),
    Statement(
        "e",
        "With RRT*, the critical speed lies between 1.0× and 1.5×.",
        "1.0× … 1.5×",
        "As for (b), between 1.0× and 1.5×.",
    ),
    Statement(
        "f1",
        "Evaders escape more often when the Police rely on a particle filter.",
        "more often",
        (
            "Three comparisons, one at each speed of Fig. 3. Confirmed if all are higher; refuted if one is "
            "lower, or if all intervals rule out a rise by more than 5 points."
        ),
    ),
    Statement(
        "f2",
        "Knowledge of the Police matters less at high speeds.",
        "less",
        (
            "The rise by the particle filter at 0.8× to 1.0× together, less that at 2.0× to 3.0× together, with "
            "its 95 % interval. Confirmed if the interval lies above 0; refuted if it lies below."
        ),
    ),
    Statement(
        "g",
        "RRT* of circular arcs rarely finds a path from the start to the exit within 5000 iterations.",
        "rarely",
        (
            "Plans of the first evader at its published start, 5000 iterations each (fewer if a path is found "
            "earlier). Confirmed if the Wilson interval of the chance to find a path lies below one half; refuted "
            "if it lies above."
        ),
    ),
    Statement(
        "h",
        "RRT* paths visibly avoid the Police.",
        "visibly",
        (
            "Plans from the published start among Police at random places: the distance of the path to the "
            "nearest Police, minus that of the shortest path, plan by plan. Confirmed if the 95 % interval of the "
            "mean lies above 0.25 m, a quarter of a street; refuted if it lies below."
        ),
    ),
)
#: Largest difference of chances that counts as none.
_MARGIN = 0.05
#: Iterations after which the paper stopped searching on arcs.
_MAX_PAPER_ITERATIONS = 5000
#: Minimum increase of the distance from the Police that counts as avoiding them (m): a quarter of a street.
_MIN_AVOIDANCE = 0.25
#: Before findings of games, and of single plans.
_GAMES = ("With our planners on random layouts", "In the published game")
_PLANS = ("With our parameters", "With the paper's parameters")
#: Rule of the values of the figures.
_VALUES = (
    "Refuted if Fisher's exact test of our games against the published ten, by Holm's method over the values of the figure,"
    " has p < 0.05; confirmed if not, and our 95 % interval by game lies within that of the published ten (Wilson)."
)


class Question(NamedTuple):
    """A statement with our findings: with our planners or parameters, and with the paper's; texts before both."""

    statement: Statement
    ours: Finding
    paper: Finding
    settings: tuple[str, str]


def questions(evidence: Evidence) -> list[Question]:
    """All statements with their findings."""

    def games(test: Callable[[Study], Finding], name: str, study: Study | None) -> tuple[Finding, Finding, tuple[str, str]]:
        paper = evidence.studies.get(f"{name}_paper")
        findings = (
            Finding.missing(f"experiment {name}{suffix}") if of is None else test(of)
            for of, suffix in ((study, ""), (paper, "_paper"))
        )
        return (*findings, _GAMES)  # type: ignore[return-value]

    def speed(test: Callable[[Study], Finding]) -> tuple[Finding, Finding, tuple[str, str]]:
        return games(test, "escape_vs_speed", evidence.all_speeds())

    def knowledge(test: Callable[[Study], Finding]) -> tuple[Finding, Finding, tuple[str, str]]:
        return games(test, "knowledge", evidence.studies.get("knowledge"))

    def plans(test: Callable[[list[Plan], str], Finding], case: str) -> tuple[Finding, Finding, tuple[str, str]]:
        if evidence.plans is None:
            return Finding.missing("single plans"), Finding.missing("single plans"), _PLANS
        return test(evidence.plans, case), test(evidence.plans, f"{case}_paper"), _PLANS

    findings = (
        speed(_order),
        speed(lambda study: _within(study, FIELD, Interval(1.75, 2.25))),
        speed(_drop),
        speed(_never),
        speed(lambda study: _within(study, LINE, Interval(1.0, 1.5))),
        knowledge(_raises),
        knowledge(_fades),
        plans(_arcs, "rrt_star_arc"),
        plans(_avoids, "rrt_star_line"),
    )
    return [Question(statement, *found) for statement, found in zip(_STATEMENTS, findings, strict=True)]


def claims(evidence: Evidence) -> list[Claim]:
    """The statements, each with two findings, and the values of the figures."""
    found = []
    for question in questions(evidence):
        letter, text, words_, rule = question.statement
        for side, setting, finding in zip(("ours", "paper"), question.settings, question[1:3], strict=True):
            statement = f"({letter}) {text} {setting}."
            found.append(Claim(Paper.CHASE, f"{letter}.{side}", statement, Published(words_), rule, finding))
    for number_, name, values in ((2, "escape_vs_speed_paper", published.SPEED), (3, "knowledge_paper", published.KNOWLEDGE)):
        study = evidence.studies.get(name)
        compared = study.compared(values) if study else {}
        for value in values:
            title = study.title(value.method) if study else value.method
            text = f"Fig. {number_}: chance to escape, {title}, at {words.ratio(value.ratio)}"
            key, published_ = f"fig{number_}.{value.method}.{value.ratio:g}", Published.number(value.share, SHARE)
            found.append(Claim(Paper.CHASE, key, text, published_, _VALUES, _value(value, compared)))
    return found


def _value(value: published.Published, compared: Mapping[published.Published, tuple[Cell, float]]) -> Finding:
    """Compares a published value with our games."""
    if value not in compared:
        return Finding.missing(f"{value.method} at {words.ratio(value.ratio)}")
    cell, p = compared[value]
    sample = cell.escapes
    interval = sample.interval()
    verdict = Verdict.CONFIRMED if interval.is_within(value.interval) else Verdict.UNDECIDED
    if p < 0.05:
        verdict = Verdict.REFUTED
    ours = Measured.number(sample.share or 0.0, interval, SHARE, sample.groups, "games")
    return Finding(verdict, ours, [f"Fisher's exact test, by Holm's method: {words.p_value(p)}"])


class _Order(Enum):
    """Result of a comparison. Not lower: not by more than the margin, but not significantly higher."""

    HIGHER = "higher"
    LOWER = "lower"
    NOT_LOWER = "not lower"
    OPEN = "open"


@dataclass(frozen=True)
class _Comparison:
    """One of several comparisons; ``games`` is the number of seeds that both cells have."""

    label: str
    difference: Difference
    interval: Interval
    p_value: float
    games: int
    order: _Order

    def __str__(self) -> str:
        more, fewer = self.difference.larger
        return (
            f"{self.label}: {words.points(self.difference.value)} points ({words.point_range(self.interval)}), more in"
            f" {more} games, fewer in {fewer}, {words.p_value(self.p_value)}: {self.order.value}"
        )


def _family(pairs: Sequence[tuple[str, BySeed, BySeed]]) -> list[_Comparison] | None:
    """Compares the first with the second of every pair, with Holm's p-values and simultaneous intervals.

    None if a pair has no common seed.
    """
    differences = []
    for _, first, second in pairs:
        difference = Difference.of(first, second)
        if difference is None:
            return None
        differences.append(difference)
    z = simultaneous_z(len(pairs))
    found = []
    for (label, first, second), d, p in zip(pairs, differences, holm([d.p_value for d in differences]), strict=True):
        interval, (more, fewer) = d.interval(z), d.larger
        # The test counts games, the interval counts evaders.
        if p < 0.05 and (more > fewer) == (d.value > 0.0):
            order = _Order.HIGHER if d.value > 0.0 else _Order.LOWER
        else:
            order = _Order.NOT_LOWER if interval.low >= -_MARGIN else _Order.OPEN
        found.append(_Comparison(label, d, interval, p, len(first.keys() & second.keys()), order))
    return found


def _of_family(comparisons: Sequence[_Comparison], verdict: Verdict) -> Finding:
    """A finding that rests on the comparison with the smallest difference."""
    least = min(comparisons, key=lambda c: c.difference.value)
    ours = Measured.number(least.difference.value, least.interval, POINTS, least.games, "games")
    if len(comparisons) > 1:
        ours = replace(ours, text=f"{ours.text}, the least of {len(comparisons)}")
    return Finding(verdict, ours, [str(comparison) for comparison in comparisons])


def _order(study: Study) -> Finding:
    """Claim (a)."""
    pairs = []
    for r in SPEED_RATIOS:
        for first, second in ((LINE, FIELD), (FIELD, BRAITENBERG)):
            a, b = study.cell(first, r), study.cell(second, r)
            if a is None or b is None:
                return Finding.missing(f"{first} and {second} at {words.ratio(r)}")
            label = f"{study.title(first)} less {study.title(second)} at {words.ratio(r)}"
            pairs.append((label, a.games, b.games))
    comparisons = _family(pairs)
    if comparisons is None:
        return Finding.missing("games in every cell")
    orders = {comparison.order for comparison in comparisons}
    verdict = Verdict.UNDECIDED if _Order.OPEN in orders else Verdict.CONFIRMED
    return _of_family(comparisons, Verdict.REFUTED if _Order.LOWER in orders else verdict)


def _within(study: Study, method: str, claimed: Interval) -> Finding:
    """Claims (b) and (e)."""
    crossings, speeds = study.crossings(method), study.ratios(method)
    if crossings is None or len(speeds) < 2:
        return Finding.missing(f"{method} at two speeds or more")
    low, high = crossings.range
    verdict = Verdict.CONFIRMED if crossings.range.is_within(claimed) else Verdict.UNDECIDED
    if low >= claimed.high or high <= claimed.low:
        verdict = Verdict.REFUTED
    brackets = study.brackets(method, crossings)
    games = min(cell.escapes.groups for r in speeds if (cell := study.cell(method, r)))
    ours = Measured(brackets, None, crossings.range, SPEED, games, "games per speed")
    numbers = [
        f"Half of the evaders escape: {brackets}",
        f"Range by the intervals: {words.ratio_range(crossings.range)}",
    ]
    return Finding(verdict, ours, numbers)


def _drop(study: Study) -> Finding:
    """Claim (c)."""
    faster = (2.5, 3.0)
    fast, slow = study.pooled(FIELD, faster), study.cell(FIELD, 2.0)
    if fast is None or slow is None:
        return Finding.missing("the potential field at 2.0×, 2.5× and 3.0×")
    comparisons = _family([(f"{words.ratios(faster)} less {words.ratio(2.0)}", fast, slow.games)])
    if comparisons is None:
        return Finding.missing("games in every cell")
    verdicts = {_Order.LOWER: Verdict.CONFIRMED, _Order.OPEN: Verdict.UNDECIDED}
    return _of_family(comparisons, verdicts.get(comparisons[0].order, Verdict.REFUTED))


def _never(study: Study) -> Finding:
    """Claim (d)."""
    speeds = study.ratios(BRAITENBERG)
    if not speeds:
        return Finding.missing("Braitenberg vehicles")
    z = simultaneous_z(len(speeds))
    cells = [(r, cell.escapes) for r in speeds if (cell := study.cell(BRAITENBERG, r))]
    found = [(r, sample.share or 0.0, sample.interval(z), sample.groups) for r, sample in cells]
    verdict = Verdict.CONFIRMED if all(interval.high < 0.5 for _, _, interval, _ in found) else Verdict.UNDECIDED
    if any(interval.low > 0.5 for _, _, interval, _ in found):
        verdict = Verdict.REFUTED
    # Of equal ones the last.
    r, value, interval, games = max(reversed(found), key=lambda cell: cell[1])
    ours = Measured.number(value, interval, SHARE, games, "games")
    ours = replace(ours, text=f"{ours.text}, the most, at {words.ratio(r)}")
    numbers = [f"At {words.ratio(r)}: {words.share(value)} ({words.shares(i)})" for r, value, i, _ in found]
    return Finding(verdict, ours, numbers)


def _raises(study: Study) -> Finding:
    """Claim (f), first part."""
    pairs = []
    for r in KNOWLEDGE_RATIOS:
        a, b = study.cell(FILTER, r), study.cell(EXACT, r)
        if a is None or b is None:
            return Finding.missing(f"both kinds of knowledge at {words.ratio(r)}")
        label = f"{study.title(FILTER)} less {study.title(EXACT)} at {words.ratio(r)}"
        pairs.append((label, a.games, b.games))
    comparisons, reverse = _family(pairs), _family([(label, b, a) for label, a, b in pairs])
    if comparisons is None or reverse is None:
        return Finding.missing("games in every cell")
    orders = {comparison.order for comparison in comparisons}
    none_rises = all(comparison.order in (_Order.NOT_LOWER, _Order.HIGHER) for comparison in reverse)
    verdict = Verdict.CONFIRMED if orders == {_Order.HIGHER} else Verdict.UNDECIDED
    return _of_family(comparisons, Verdict.REFUTED if _Order.LOWER in orders or none_rises else verdict)


def _fades(study: Study) -> Finding:
    """Claim (f), second part: a conjecture of the paper."""
    high = (2.0, 2.5, 3.0)
    cells = [study.pooled(method, speeds) for speeds in (KNOWLEDGE_RATIOS, high) for method in (FILTER, EXACT)]
    missing = Finding.missing("both kinds of knowledge at 0.8× to 1.0× and at 2.0× to 3.0×")
    a, b, c, d = cells
    if a is None or b is None or c is None or d is None:
        return missing
    less, slow, fast = difference_of_differences((a, b, c, d)), Difference.of(a, b), Difference.of(c, d)
    if less is None or slow is None or fast is None:
        return missing
    interval = less.interval()

    def rise(at: Sequence[float], d: Difference) -> str:
        return f"Rise at {words.ratios(at)}: {words.points(d.value)} points ({words.point_range(d.interval())})"

    numbers = [
        rise(KNOWLEDGE_RATIOS, slow),
        rise(high, fast),
        f"Less by {words.points(less.value)} points ({words.point_range(interval)})",
    ]
    ours = Measured.number(less.value, interval, POINTS, less.count, "seeds")
    return Finding(Verdict.above(interval, 0.0), ours, numbers)


def _arcs(plans: list[Plan], case: str) -> Finding:
    """Claim (g)."""
    tried = [p for p in plans if (p.case, p.scene) == (case, "start") and p.iterations <= _MAX_PAPER_ITERATIONS]
    if not tried:
        return Finding.missing(f"plans of {case} at the start of a game")
    found = sum(plan.found for plan in tried)
    interval, share = wilson(found, len(tried)), found / len(tried)
    most = max(plan.iterations for plan in tried)
    numbers = [
        f"A path within {most} iterations: {found} of {len(tried)} ({words.share(share)}, {words.shares(interval)})"
    ]
    mean = Mean.of(plan.length_m for plan in tried if plan.length_m is not None)
    shortest = next((plan.shortest_m for plan in tried if plan.shortest_m is not None), None)
    if mean is not None and shortest is not None:
        numbers.append(
            f"Mean length of the paths: {words.decimals(mean.value, 2)} m; the shortest path is"
            f" {words.decimals(shortest, 2)} m"
        )
    ours = Measured.number(share, interval, SHARE, len(tried), "plans")
    return Finding(Verdict.below(interval, 0.5), ours, numbers)


def _avoids(plans: list[Plan], case: str) -> Finding:
    """Claim (h)."""
    paired = [
        (plan, plan.closest_m - plan.shortest_closest_m)
        for plan in plans
        if (plan.case, plan.scene) == (case, "random") and plan.found
        if plan.closest_m is not None and plan.shortest_closest_m is not None
    ]
    gains = [gain for _, gain in paired]
    mean = Mean.of(gains)
    if mean is None:
        return Finding.missing(f"plans of {case} among Police at random places")
    interval = mean.interval()
    value, low, high = (words.decimals(v, 2) for v in (mean.value, *interval))
    farther, nearer = sum(gain > 0.01 for gain in gains), sum(gain < -0.01 for gain in gains)
    numbers = [
        f"Farther from the nearest Police by {value} m on average ({low} … {high} m), {len(gains)} plans",
        f"Farther in {farther}, nearer in {nearer} of them",
    ]
    detour = Mean.of(plan.length_m / plan.shortest_m - 1.0 for plan, _ in paired if plan.length_m and plan.shortest_m)
    if detour is not None:
        numbers.append(f"The path is {words.share(detour.value)} longer on average")
    ours = Measured.number(mean.value, interval, number(2, "m"), len(gains), "plans")
    return Finding(Verdict.above(interval, _MIN_AVOIDANCE), ours, numbers)
