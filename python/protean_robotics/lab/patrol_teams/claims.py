"""The targets of patrols of teams, as claims."""

from collections.abc import Callable, Sequence

from ..claim import Claim, Finding, Measured, Paper, Published, Unit, Verdict, number
from .evidence import FAILURE, LAP_S, TEAM, Cell, Evidence

#: Rule of all: guarantees of every mission, not means.
_EVERY = "A bound of every mission: confirmed if all missions keep it, refuted if one does not."
_RATIO, _SECONDS = number(3), number(1, "s")
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
    return found


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
