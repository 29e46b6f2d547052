"""The page ``docs/results/patrol-teams.md``."""

from typing import Any

from .. import words
from ..claim import Claim
from ..figures import Chart, Point, Series
from ..page import Page, fill
from ..statistics import wilson
from .claims import PUBLISHED, claims
from .evidence import ATTACKS, EXPERIMENTS, FAILURE, METHODS, PREDICTABILITY, STRATEGIES, TEAM, Cell, Evidence, Study

#: Names of the cases of the experiment in which a guard fails.
_CASES = {
    "spread": "spread, none fails",
    "convoy": "each from the first waypoint",
    "failure": "spread, one stands between walls",
    "trapped": "spread, one drives around between walls",
}
#: Names of the cases with an observer.
_PATROLS = {
    "zigzag": "keyed zig-zag along the contour",
    "cyclic": "cyclic, from corner to corner",
    "reactive": "conscientious reactive among all corners",
    "random": "random walk among all corners",
    "markov": "Markov chain among all corners, keyed",
}
#: Names of the cases with adversaries.
_GUARDS = {
    "contour": "on the contour",
    "keyed": "zig-zag, keyed",
    "keyed_wide": "wider zig-zag, keyed",
}


def build(evidence: Evidence) -> Page:
    """Builds the page."""
    values: dict[str, Any] = dict.fromkeys(EXPERIMENTS)
    provenance, images = "", []
    team, failure = evidence.studies.get(TEAM), evidence.studies.get(FAILURE)
    if team is not None:
        values[TEAM] = "".join(_team(team, cell) for cell in team.cells)
        images.append(_chart(team))
    if failure is not None:
        values[FAILURE] = "".join(map(_failure, failure.cells))
    if (observed := evidence.studies.get(PREDICTABILITY)) is not None:
        values[PREDICTABILITY] = "".join(map(_observed, observed.cells))
        images.append(_errors(observed))
    if (attacked := evidence.studies.get(ATTACKS)) is not None:
        values[ATTACKS] = "".join(map(_attacked, attacked.cells))
    found = claims(evidence)
    strategies = [claim for claim in found if claim.key.startswith("strategy.")]
    if STRATEGIES in evidence.studies:
        values[STRATEGIES] = "".join(map(_strategy, strategies))
    for name, study in evidence.studies.items():
        provenance += words.provenance(name, study.seeds, study.program)
    verdicts = "".join(_verdict(claim) for claim in found if claim not in strategies)
    return Page(fill("patrol-teams.md", values | {"verdicts": verdicts, "provenance": provenance}), images)


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |\n"


def _mean(values: list[float], digits: int) -> str:
    return words.decimals(sum(values) / len(values), digits) if values else "–"


def _most(values: list[float], digits: int) -> str:
    return words.decimals(max(values), digits) if values else "–"


def _least(values: list[float], digits: int) -> str:
    return words.decimals(min(values), digits) if values else "–"


def _team(study: Study, cell: Cell) -> str:
    eighth = study.lengths[cell.contour] / 8.0
    return _row(
        cell.contour,
        str(cell.guards),
        _mean(cell.mean(), 1),
        _most(cell.worst(), 1),
        _most([worst / cell.share_s for worst in cell.worst()], 3),
        _least(cell.nearest(), 2),
        _least([nearest / eighth for nearest in cell.nearest()], 2),
    )


def _failure(cell: Cell) -> str:
    laps = [worst / (cell.share_s * cell.guards) for worst in cell.worst()]
    return _row(_CASES[cell.case], _mean(cell.mean(), 1), _least(cell.worst(), 1), _most(cell.worst(), 1), _most(laps, 2))


def _strategy(claim: Claim) -> str:
    name = claim.key.removeprefix("strategy.")
    known_as, runs = PUBLISHED[name]
    theirs = ", ".join(words.decimals(run, 1) for run in runs)
    return _row(f"`{name}`", known_as, theirs, claim.ours.text, claim.ours.interval_text, claim.verdict.markdown)


def _observed(cell: Cell) -> str:
    errors = (words.decimals(error, 2) for _, error in sorted(cell.errors().items()))
    return _row(_PATROLS[cell.case], *errors, _mean(cell.mean(), 1), _most(cell.worst(), 1))


def _attacked(cell: Cell) -> str:
    shares = (_share(*cell.attacks(method)) for method in METHODS)
    return _row(_GUARDS[cell.case], f"{cell.duration:g}", *shares)


def _share(detected: int, attacks: int) -> str:
    if attacks == 0:
        return "–"
    low, high = (words.decimals(100.0 * end, 1) for end in wilson(detected, attacks))
    return f"{words.decimals(100.0 * detected / attacks, 1)} ({low} … {high})"


def _verdict(claim: Claim) -> str:
    return _row(claim.text, claim.published.text, claim.ours.text, str(claim.ours.n), claim.verdict.markdown)


def _chart(study: Study) -> Chart:
    """The worst idleness by the number of guards."""
    curves = []
    for contour in study.lengths:
        cells = (cell for cell in study.cells if cell.contour == contour and cell.worst())
        points = [Point(float(cell.guards), max(cell.worst()) / cell.share_s) for cell in cells]
        curves.append(Series(contour, points))
    return Chart("patrol-teams-idleness", "guards", "worst idleness by (lap / guards)", curves, share=False)


def _errors(study: Study) -> Chart:
    """Errors of the observer by the time by which it predicts ahead."""
    curves = []
    for cell in study.cells:
        points = [Point(horizon, error) for horizon, error in sorted(cell.errors().items())]
        curves.append(Series(_PATROLS[cell.case], points))
    return Chart("patrol-teams-predictability", "time ahead [s]", "error of the best method [m]", curves, share=False)
