"""The page ``docs/results/patrol.md``."""

from functools import partial
from typing import Any

from ..._core import lab
from .. import words
from ..figures import Chart, Point, Series, left_out_share
from ..page import Page, fill
from .evidence import ALPHA, COVERAGE, EXPERIMENTS, SQUARE, Cell, Evidence, Study, Value, covered, lap, least_error, visits

#: Time of a lap in the paper's first case, and in the experiment (s).
_T_MAX = 120.0
#: The width that the paper chooses (m), with its speed (m/s) and MAE (m).
_PUBLISHED = (1.7, 0.9651, 0.9352)
#: Distances at which the covered part is compared (m).
_WAYS = (250.0, 500.0, 1000.0, 2000.0)
#: Table 1 of the coverage paper: name of the values, whether they are those of the map itself, the paper's results for 2000
#: and for 10 000 values, and the limit for independent coordinates.
TABLE_1 = (
    ("original", True, (0.8309, 0.8209), "8/π² = 0.8106"),
    ("arcsine, arccosine", False, (0.6830, 0.6758), "2/3 = 0.6667"),
)
#: Numbers of values.
LENGTHS = (2000, 10_000)
#: A key of the exact map.
_KEY = (123_456_789_012_345_678, 987_654_321_098_765_432)


def build(evidence: Evidence) -> Page:
    """Builds the page."""
    values: dict[str, Any] = dict.fromkeys(EXPERIMENTS)
    provenance, images = "", []
    for name, rows in ((ALPHA, _alpha), (SQUARE, _square), (COVERAGE, _coverage)):
        study = evidence.studies.get(name)
        if study is not None:
            values[name] = {"rows": "".join(map(rows, study.cells)), "late": _late(study) if name == SQUARE else ""}
            provenance += words.provenance(name, study.seeds, study.program)
    alpha, coverage = evidence.studies.get(ALPHA), evidence.studies.get(COVERAGE)
    if alpha is not None:
        images.append(_by_alpha("patrol-speed", alpha, "speed needed [m/s]", _speed, _PUBLISHED[1]))
        images.append(_by_alpha("patrol-mae", alpha, "MAE [m]", _mae, _PUBLISHED[2]))
    if coverage is not None:
        images.append(_by_way(coverage))
    return Page(fill("patrol.md", values | {"sequences": _sequences(), "provenance": provenance}), images)


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |\n"


def _mean(cell: Cell, value: Value) -> str:
    """Mean with its 95 % interval; without one if all missions have the same value."""
    mean, values = cell.mean(value), cell.values(value)
    if mean is None:
        return "–"
    text = words.decimals(mean.value, 2)
    return f"{text} ± {words.decimals(mean.interval().width / 2.0, 2)}" if len(set(values)) > 1 else text


def _speed(row: dict[str, Any]) -> float | None:
    """Speed of a lap in the time of the paper's first case (m/s)."""
    length = lap(row, "planned", "length_m")
    return None if length is None else length / _T_MAX


def _mae(row: dict[str, Any]) -> float | None:
    return lap(row, "planned", "mae_m")


def _alpha(cell: Cell) -> str:
    values = (
        _speed,
        _mae,
        lambda row: lap(row, "driven", "mae_m"),
        lambda row: lap(row, "planned", "maa"),
        lambda row: lap(row, "planned", "maa_fold"),
    )
    return _row(cell.case, cell.value, *(_mean(cell, value) for value in values))


def _square(cell: Cell) -> str:
    def visit(row: dict[str, Any]) -> dict[str, Any]:
        return visits(row) or {}

    values = (
        lambda row: lap(row, "driven", "mae_m"),
        lambda row: lap(row, "driven", "turns"),
        lambda row: lap(row, "driven", "maa"),
        lambda row: lap(row, "driven", "maa_fold"),
        _longest_lap,
        lambda row: left_out_share(visit(row)) if visit(row) else None,
    )
    error = _mean(cell, lambda row: least_error(row, 2.0, knows_method=False))
    contacts = str(sum(row["contacts"] for row in cell.rows.values()))
    return _row(cell.value, cell.case, *(_mean(cell, value) for value in values), contacts, error)


def _late(study: Study) -> str:
    """Which planners need more than the time of the paper's first case for their longest lap, and among which obstacles."""
    found = [
        f"`{cell.case}` ({cell.value})"
        for cell in study.cells
        if (mean := cell.mean(_longest_lap)) is not None and mean.value > _T_MAX
    ]
    return f"Longest laps above {_T_MAX:g} s on average: {', '.join(found) if found else 'none'}."


def _longest_lap(row: dict[str, Any]) -> float | None:
    visit = visits(row)
    return visit["longest_lap_s"] if visit else None


def _coverage(cell: Cell) -> str:
    def share(way: float) -> str:
        mean = cell.mean(lambda row: covered(row, way))
        return "–" if mean is None else f"{mean.value:.3f}"

    values = (
        lambda row: row["coverage"]["unevenness"] if row["coverage"] else None,
        lambda row: least_error(row, 2.0, knows_method=False),
        lambda row: least_error(row, 5.0, knows_method=False),
        lambda row: least_error(row, 5.0, knows_method=True),
    )
    return _row(cell.case.replace("_", " "), *map(share, _WAYS), *(_mean(cell, value) for value in values))


def _sequences() -> str:
    """Rows of Table 1 of the coverage paper, computed now."""
    text = ""
    for name, raw, published, limit in TABLE_1:
        for n, theirs in zip(LENGTHS, published, strict=True):
            ours = (lab.chebyshev_difference(raw, n), lab.chebyshev_difference(raw, n, _KEY))
            text += _row(name, str(n), f"{theirs:.4f}", *(f"{value:.4f}" for value in ours), limit)
    return text


def _by_alpha(name: str, study: Study, y_label: str, value: Value, published: float) -> Chart:
    """A quantity by the width of the zig-zag (Fig. 6 and 10)."""
    curves = []
    for case, title in (("paper_fit", "as the paper's\nnumbers were made"), ("default", "default")):
        cells = ((cell, cell.mean(value)) for cell in study.cells if cell.case == case)
        points = [
            Point(float(cell.value), mean.value, mean.interval() if mean.count > 1 else None)
            for cell, mean in cells
            if mean is not None
        ]
        reference = [Point(_PUBLISHED[0], published)] if case == "paper_fit" else []
        curves.append(Series(title, points, reference))
    return Chart(name, "width of the zig-zag, α [m]", y_label, curves, share=False, reference="the paper")


def _by_way(study: Study) -> Chart:
    """The covered part by the distance driven."""
    curves = []
    for cell in study.cells:
        means = ((way, cell.mean(partial(covered, way=way))) for way in _WAYS)
        points = [Point(way, mean.value) for way, mean in means if mean is not None]
        curves.append(Series(cell.case.replace("_", " "), points))
    return Chart("coverage-by-way", "way driven [m]", "covered", curves)
