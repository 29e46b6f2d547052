"""The targets of patrols of teams, and results of `patrolling_sim`, as claims."""

from collections.abc import Callable, Sequence

from .. import words
from ..claim import Claim, Finding, Measured, Paper, Published, Unit, Verdict, number
from ..statistics import Mean
from .evidence import FAILURE, LAP_S, STRATEGIES, TEAM, Cell, Evidence

#: Rule of all: guarantees of every mission, not means.
_EVERY = "A bound of every mission: confirmed if all missions keep it, refuted if one does not."
_RATIO, _SECONDS = number(3), number(1, "s")
#: Rule of results of other programs.
_RUNS = (
    "Runs of theirs beside missions of ours: confirmed if all of their runs lie in our 95 % prediction interval for one more"
    " mission, refuted if none does, undecided otherwise."
)
#: Mean time between two visits of a node by strategy, four robots on the map `grid` (s): "Avg Avg Graph Idl" after ten cycles of each
#: run in `results/grid_*_4.xls` of github.com/davidbsp/patrolling_sim, commit 5eb6f959; with the name there.
PUBLISHED: dict[str, tuple[str, tuple[float, ...]]] = {
    "conscientious_reactive": ("CR", (62.67, 64.37, 60.06, 57.98, 57.29)),
    "heuristic_reactive": ("HCR", (63.46, 69.08, 57.70)),
    "heuristic_pathfinder": ("HPCC", (56.29, 55.55, 58.17)),
    "greedy": ("GBS", (59.21, 60.52, 59.87)),
    "state_exchange": ("SEBS", (55.51, 56.48)),
    "partition": ("MSP", (63.08, 64.74)),
    "cyclic": ("CGG", (65.95, 66.97)),
}
#: Contours.
_CONTOURS = ("octagon", "angle", "triangle")
#: Bounds: worst idleness by its share of a lap; least distance by an eighth of the contour.
_MAX_IDLENESS, _MIN_DISTANCE = 1.1, 1.0


def claims(evidence: Evidence) -> list[Claim]:
    """All claims."""
    team, failure = evidence.studies.get(TEAM), evidence.studies.get(FAILURE)
    found = []
    for contour in _CONTOURS:
        cells = [cell for cell in team.cells if cell.contour == contour] if team else []
        eighth = team.lengths[contour] / 8.0 if team and cells else 1.0
        found += [
            _bound(
                f"idleness.{contour}",
                f"2 to 7 spread guards, {contour}: worst idleness by (lap / guards)",
                _MAX_IDLENESS,
                _RATIO,
                _missions(cells, lambda cell: [worst / cell.share_s for worst in cell.worst()]),
                TEAM,
            ),
            _bound(
                f"distance.{contour}",
                f"2 to 7 spread guards, {contour}: least distance by an eighth of the contour",
                _MIN_DISTANCE,
                _RATIO,
                _missions(cells, lambda cell: [nearest / eighth for nearest in cell.nearest()]),
                TEAM,
                is_most=False,
            ),
        ]
    for case, title in (("failure", "stands"), ("trapped", "drives around")):
        cells = [cell for cell in failure.cells if cell.case == case] if failure else []
        text = f"A guard of four that {title} between walls is replaced within a lap: worst idleness"
        found.append(_bound(f"failed.{case}", text, LAP_S, _SECONDS, _missions(cells, Cell.worst), FAILURE))
    strategies = evidence.studies.get(STRATEGIES)
    cells_of = {cell.strategy: cell for cell in strategies.cells} if strategies else {}
    return found + [_runs(strategy, cells_of.get(strategy)) for strategy in PUBLISHED]


def _runs(strategy: str, cell: Cell | None) -> Claim:
    """Compares runs of theirs with missions of ours."""
    name, runs = PUBLISHED[strategy]
    finding = Finding.missing(f"experiment {STRATEGIES}")
    mean = Mean.of(cell.interval()) if cell else None
    if mean is not None:
        interval = mean.prediction()
        inside = sum(map(interval.contains, runs))
        verdict = {len(runs): Verdict.CONFIRMED, 0: Verdict.REFUTED}.get(inside, Verdict.UNDECIDED)
        finding = Finding(verdict, Measured.number(mean.value, interval, _SECONDS, mean.count, "missions"))
    ends = " … ".join(words.decimals(end, 1) for end in (min(runs), max(runs)))
    published = Published(f"{ends} s in {len(runs)} runs", sum(runs) / len(runs))
    text = f"{name}, 4 robots on the map grid of patrolling_sim: mean time between two visits of a node"
    return Claim(Paper.TEAMS, f"strategy.{strategy}", text, published, _RUNS, finding)


def _missions(cells: Sequence[Cell], values: Callable[[Cell], list[float]]) -> list[float]:
    return [value for cell in cells for value in values(cell)]


def _bound(
    key: str, text: str, bound: float, unit: Unit, values: list[float], experiment: str, *, is_most: bool = True
) -> Claim:
    """Tests if the values of all missions keep a bound, at most or at least."""
    finding = Finding.missing(f"experiment {experiment}")
    if values:
        end = max(values) if is_most else min(values)
        keeps = end <= bound if is_most else end >= bound
        ours = Measured(unit.value(end), end, None, unit, len(values), "missions")
        finding = Finding(Verdict.CONFIRMED if keeps else Verdict.REFUTED, ours)
    published = Published(f"at {'most' if is_most else 'least'} {unit.value(bound)}", bound)
    return Claim(Paper.TEAMS, key, text, published, _EVERY, finding)
