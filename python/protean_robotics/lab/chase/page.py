"""The page ``docs/results/chase.md``: curves, a table of all cells, critical speeds, and the claims with verdicts."""

from collections.abc import Sequence
from typing import Any, NamedTuple

from .. import figures, words
from ..page import Page, fill
from ..statistics import wilson
from .claims import Question, questions
from .evidence import EXPERIMENTS, FIELD, KNOWLEDGE, SPEED, SPEED_RATIOS, Evidence, Published, Study, same


class _Part(NamedTuple):
    """One experiment of the page."""

    experiment: str
    image: str
    title: str
    conditions: str
    published: Sequence[Published] = ()


_PARTS = (
    _Part(
        "escape_vs_speed",
        "chase-escape-vs-speed",
        "Chance of escape against speed, random layouts",
        "Police 0.3 m/s with exact knowledge, our planners.",
    ),
    _Part(
        "escape_vs_speed_paper",
        "chase-escape-vs-speed-paper",
        "Chance of escape against speed, the paper's parameters",
        "Police 0.3 m/s with exact knowledge, presets of the paper.",
        SPEED,
    ),
    _Part(
        "knowledge",
        "chase-knowledge",
        "Chance of escape and what the Police know, random layouts",
        "Police 0.3 m/s; evaders on a potential field that plans around them.",
    ),
    _Part(
        "knowledge_paper",
        "chase-knowledge-paper",
        "Chance of escape and what the Police know, the paper's parameters",
        "RRT* evaders, Police 0.3 m/s, presets of the paper.",
        KNOWLEDGE,
    ),
)


def build(evidence: Evidence) -> Page:
    """Builds the page."""
    values: dict[str, Any] = dict.fromkeys(EXPERIMENTS)
    images, provenance = [], ""
    studies = dict(evidence.studies)
    all_speeds = evidence.all_speeds()
    if all_speeds is not None:
        studies["escape_vs_speed"] = all_speeds
    for part in _PARTS:
        study = studies.get(part.experiment)
        if study is None:
            continue
        cells = _cells(study, part.published) if part.published else _by_speed(study)
        found = {"cells": cells, "crossings": _crossings(study)}
        if part.published:
            found |= {"verdict": _verdict(study, part.published), "undecided": _undecided(study)}
        values[part.experiment] = found
        images.append(_chart(study, part))
        provenance += words.provenance(part.experiment, study.seeds, study.program)
    more = evidence.studies.get("escape_vs_speed_rrt_star")
    if more is not None:
        provenance += words.provenance(more.name, more.seeds, more.program)

    def verdict(question: Question) -> str:
        letter, findings = question.statement.letter, (question.ours, question.paper)
        verdicts = " | ".join(finding.verdict.markdown for finding in findings)
        return f"| [{letter}](#claim-{letter}) | {question.statement.text} | {verdicts} |\n"

    def section(question: Question) -> str:
        statement = question.statement
        text = f"### Claim {statement.letter}\n\n{statement.text}\n\n*Rule.* {statement.rule}\n\n"
        for setting, finding in zip(question.settings, (question.ours, question.paper), strict=True):
            numbers = "".join(f"- {line}\n" for line in finding.numbers)
            text += f"{setting}: {finding.verdict.markdown}\n\n{numbers}\n"
        return text

    asked = questions(evidence)
    values["verdicts"] = "".join(map(verdict, asked))
    values["claims"] = "".join(map(section, asked))
    return Page(fill("chase.md", values | {"provenance": provenance}), images)


def _crossings(study: Study) -> str:
    """Rows of the table of critical speeds: method, brackets, range."""
    text = ""
    for method, title in study.titles.items():
        crossings = study.crossings(method)
        found = (study.brackets(method, crossings), words.ratio_range(crossings.range)) if crossings else ("–", "–")
        text += f"| {words.in_table(title)} | {' | '.join(found)} |\n"
    return text


def _by_speed(study: Study) -> str:
    """A table with a row for every speed and a column for every method: the chance with its interval by game.

    The first row has the number of games per cell.
    """

    def row(cells: Sequence[str]) -> str:
        return "".join(f" {cell} |" for cell in cells) + "\n"

    def chance(method: str, speed: float) -> str:
        cell = study.cell(method, speed)
        return words.percent(cell.escapes.share or 0.0, cell.escapes.interval()) if cell else "–"

    speeds: list[float] = []
    for cell in sorted(study.cells, key=lambda cell: cell.ratio):
        if not speeds or not same(speeds[-1], cell.ratio):
            speeds.append(cell.ratio)
    methods = list(study.titles)
    text = "| |" + row([words.in_table(study.titles[method]) for method in methods])
    text += f"|---|{'---|' * len(methods)}\n"
    text += "| games |" + row([_games(study, method) for method in methods])
    for speed in speeds:
        text += f"| {words.ratio(speed)} |" + row([chance(method, speed) for method in methods])
    return text


def _games(study: Study, method: str) -> str:
    """Number of games per cell of a method, failed ones apart."""
    cells = [cell for cell in study.cells if cell.method == method]
    counts = [cell.escapes.groups for cell in cells] or [0]
    played = f"{min(counts)} to {max(counts)}" if min(counts) < max(counts) else str(counts[0])
    failed = sum(cell.failed for cell in cells)
    return f"{played} (+ {failed} failed)" if failed else played


def _cells(study: Study, published: Sequence[Published]) -> str:
    """A row for every cell: our chance with both intervals, the published value, and the test."""
    text = ""
    compared = study.compared(published)
    for cell in study.cells:
        sample = cell.escapes
        by_game, share = sample.interval(), sample.share
        theirs = next((v for v in published if v.method == cell.method and same(v.ratio, cell.ratio)), None)
        value, inside, alike = "–", "–", "–"
        if theirs is not None:
            value = words.share(theirs.share)
            if sample.games:
                inside = "yes" if by_game.contains(theirs.share) else "no"
                alike = words.p_value(compared[theirs][1])
        failed = f" (+ {cell.failed} failed)" if cell.failed else ""
        columns = (
            words.in_table(study.title(cell.method)),
            words.ratio(cell.ratio),
            f"{sample.groups}{failed}",
            f"{sample.hits} / {sample.members}",
            "–" if share is None else words.share(share),
            words.shares(wilson(sample.hits, sample.members)),
            words.shares(by_game),
            str(cell.caught),
            str(cell.held_out),
            value,
            inside,
            alike,
        )
        text += f"| {' | '.join(columns)} |\n"
    return text


def _verdict(study: Study, published: Sequence[Published]) -> str:
    """What the tests of a figure say: which published values are refuted, and on which side of our chances all lie."""
    compared = study.compared(published)
    refuted, above, below = [], 0, 0
    for value, (cell, p) in compared.items():
        ours = cell.escapes.share or 0.0
        above, below = above + (value.share > ours), below + (value.share < ours)
        if p < 0.05:
            side = "fewer" if ours < value.share else "more"
            refuted.append(f"{study.title(value.method)} at {words.ratio(value.ratio)} ({side} evaders escape here)")
    of = f"of the {len(compared)} published values"
    text = f"The tests refute {len(refuted)} {of}: {', '.join(refuted)}." if refuted else f"The tests refute none {of}."
    return f"{text} {above} of them lie above our chances, {below} below."


def _undecided(study: Study) -> str:
    """Evaders on the potential field that are still in the game at the time limit, at the speeds of Fig. 2."""
    cells = [cell for r in SPEED_RATIOS if (cell := study.cell(FIELD, r))]
    return f"{sum(cell.held_out for cell in cells)} of {sum(cell.escapes.members for cell in cells)}"


def _chart(study: Study, part: _Part) -> figures.Chart:
    """The curves of a study, with the published points."""
    curves = []
    for method, title in study.titles.items():
        cells = [cell for cell in study.cells if cell.method == method and cell.escapes.games]
        points = [figures.Point(c.ratio, c.escapes.share or 0.0, c.escapes.interval()) for c in cells]
        theirs = [figures.Point(v.ratio, v.share, v.interval) for v in part.published if v.method == method]
        curves.append(figures.Series(title, points, theirs))
    games = figures.games_text([cell.escapes.groups for cell in study.cells])
    return figures.Chart(
        name=part.image,
        title=part.title,
        subtitle=f"{part.conditions} {games}; intervals by game.",
        x_label="speed of the evaders by that of the Police",
        y_label="evaders that escape",
        series=curves,
        reference="published (about 10 games each;\ndotted: their 95 % interval)",
    )
