"""Table 2: sensitivity of the methods to their parameters."""

import math
from dataclasses import dataclass
from typing import Any

from .. import words
from ..claim import Verdict
from ..figures import Chart, Point, Series
from ..statistics import Difference, Interval, fisher_exact, holm, wilson
from .evidence import RUNS, TABLE_2, Sensitivity, Setting, Study, share

#: Cases of the experiment, and their names on the page.
CASES = {
    "vmc": "VMC, obstacles seen everywhere",
    "vmc_nodes": "VMC, at the nodes only",
    "lp": "LP, obstacles seen everywhere",
    "lp_nodes": "LP, at the nodes only",
}
#: Equivalence margin: difference of shares that does not matter.
_SMALL = 0.02

#: Settings that are one and the same set of runs here.
Group = list[tuple[Sensitivity, Setting]]


def published(group: Group) -> tuple[int, int]:
    """Published failures and runs of a group. Equal counts may be one set of runs as well and count once."""
    counts = {setting.failed for _, setting in group}
    return sum(counts), RUNS * len(counts)


@dataclass(frozen=True)
class Count:
    """Our count compared with the published one.

    Attributes
    ----------
    group
        The settings, one set of runs here.
    ours
        Our failures and runs; None without results.
    p
        P-value of Fisher's exact test, by Holm's method.
    """

    group: Group
    ours: tuple[int, int] | None
    p: float = 1.0

    @property
    def verdict(self) -> Verdict:
        """Refuted by the test; confirmed if not, and our interval hardly leaves the published share."""
        theirs = share(published(self.group))
        if self.ours is None:
            return Verdict.NO_DATA
        if self.p < 0.05:
            return Verdict.REFUTED
        close = wilson(*self.ours).is_within(Interval(theirs - _SMALL, theirs + _SMALL))
        return Verdict.CONFIRMED if close else Verdict.UNDECIDED

    @property
    def words(self) -> str:
        """Text of the comparison."""
        if self.ours is None:
            return "no results"
        if self.p >= 0.05:
            return "does not contradict"
        fewer = share(self.ours) < share(published(self.group))
        return f"**contradicts**: {'fewer' if fewer else 'more'} fail here"


def values(study: Study) -> dict[str, Any]:
    """Tables of the page."""
    tables: dict[str, Any] = {case: {"changes": _changes(study, case)} for case in CASES}
    for case in ("vmc", "vmc_nodes"):
        tables[case]["counts"] = _counts(study, case)
    return tables | {"overview": _overview(study)}


def _settings() -> Group:
    return [(row, setting) for row in TABLE_2 for setting in row.settings]


def _groups(study: Study) -> list[Group]:
    """Settings of the table, each set of runs once."""
    groups: list[Group] = []
    for row, setting in _settings():
        same = (group for group in groups if study.are_same_runs(group[0][1].name, setting.name))
        group = next(same, None)
        if group is None:
            groups.append([(row, setting)])
        else:
            group.append((row, setting))
    return groups


def _title(group: Group) -> str:
    """First cells of a row: parameters, settings and published counts."""
    columns = (
        [row.parameter for row, _ in group],
        [setting.title for _, setting in group],
        [f"{setting.failed}/{RUNS}" for _, setting in group],
    )
    return f"| {' | '.join('<br>'.join(column) for column in columns)} |"


def counted(study: Study, case: str) -> list[Count]:
    """Compares our counts of a case with the published ones; p-values by Holm's method."""
    found = [(group, study.failures(case, group[0][1].name)) for group in _groups(study)]
    p = iter(holm([fisher_exact(ours, published(group)) for group, ours in found if ours is not None]))
    return [Count(group, ours) if ours is None else Count(group, ours, next(p)) for group, ours in found]


def _counts(study: Study, case: str) -> str:
    """Our counts of a case beside the published ones."""
    text = ""
    for count in counted(study, case):
        if count.ours is None:
            text += f"{_title(count.group)} – | – | {count.words} | |\n"
            continue
        failed, of = count.ours
        interval = words.shares(wilson(failed, of))
        text += f"{_title(count.group)} {failed}/{of} | {interval} | {count.words} | {words.p_value(count.p)} |\n"
    return text


def _applies(row: Sensitivity, case: str) -> bool:
    return row.of_lp or case.startswith("vmc")


def _overview(study: Study) -> str:
    """A table with a column for every case."""
    text = ""
    for group in _groups(study):
        name = group[0][1].name
        text += _title(group)
        for case in CASES:
            found = study.failures(case, name) if any(_applies(row, case) for row, _ in group) else None
            text += f" {found[0]}/{found[1]} ({words.shares(wilson(*found))}) |" if found else " – |"
        text += f" {study.unsolvable(name)} |\n"
    return text


@dataclass(frozen=True)
class Change:
    """The effect of changing a parameter on the chance to fail, on the same seeds.

    Attributes
    ----------
    row
        The parameter.
    ours
        Our change.
    seeds
        Number of seeds with a solution under both settings.
    p
        P-value by Holm's method.
    """

    row: Sensitivity
    ours: Difference
    seeds: int
    p: float

    @property
    def verdict(self) -> tuple[Verdict, str]:
        """Verdict on the published word for the change, and its text."""
        if self.ours.interval().is_within(Interval(-_SMALL, _SMALL)):
            if self.row.sensitive:
                return Verdict.REFUTED, "**contradicts**: it hardly matters here"
            return Verdict.CONFIRMED, "confirmed: it hardly matters"
        if self.p >= 0.05:
            return Verdict.UNDECIDED, "not decided"
        if not self.row.sensitive:
            return Verdict.REFUTED, "**contradicts**: it matters here"
        if math.copysign(1.0, self.ours.value) == math.copysign(1.0, self.row.change):
            return Verdict.CONFIRMED, "confirmed"
        return Verdict.REFUTED, "**contradicts**: the other way round here"


def changed(study: Study, case: str) -> list[Change]:
    """Tests if changing a parameter changes the chance to fail."""
    found = []
    for row in TABLE_2:
        before, after = (study.failed_seeds(case, setting.name) for setting in row.settings)
        if not _applies(row, case) or before is None or after is None:
            continue
        difference = Difference.of(after, before)
        if difference is not None:
            found.append((row, difference, len(before.keys() & after.keys())))
    p = holm([difference.p_value for _, difference, _ in found])
    return [
        Change(row, difference, seeds, adjusted)
        for (row, difference, seeds), adjusted in zip(found, p, strict=True)
    ]


def _changes(study: Study, case: str) -> str:
    """Rows of the table of changes."""
    text = ""
    for change in changed(study, case):
        second_alone, first_alone = change.ours.larger
        columns = (
            change.row.parameter,
            change.row.word,
            words.points(change.row.change),
            words.points(change.ours.value),
            words.point_range(change.ours.interval()),
            f"{first_alone}, {second_alone}",
            change.verdict[1],
            words.p_value(change.p),
        )
        text += f"| {' | '.join(columns)} |\n"
    return text


def chart(study: Study) -> Chart:
    """The chart of Table 2."""

    def point(x: int, count: tuple[int, int]) -> Point:
        return Point(float(x), share(count), wilson(*count))

    curves = []
    for case, title in CASES.items():
        found = [
            (x, study.failures(case, setting.name))
            for x, (row, setting) in enumerate(_settings())
            if _applies(row, case)
        ]
        theirs = [point(x, (setting.failed, RUNS)) for x, (_, setting) in enumerate(_settings())]
        points = [point(x, count) for x, count in found if count is not None]
        curves.append(Series(title.replace(", ", ",\n"), points, theirs if case == "vmc" else []))
    return Chart(
        name="vmc-lp-sensitivity",
        title="Failed plans by setting",
        subtitle="Problems with a solution for which a method, with exactly this parametrisation,\n"
        f"finds no plan that passes the check. Seeds {study.seeds}.",
        x_label="setting",
        x_names=[setting.short for _, setting in _settings()],
        y_label="failed",
        series=curves,
        reference="published, VMC, 500 runs\neach (failure is not defined)",
    )
