"""Our results: missions of three experiments, and laps and sequences that are computed without a robot."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..._core import lab
from ..results import Results, Row
from ..statistics import Mean

#: Names of the experiments: width of the zig-zag; zig-zag, fictive obstacles and both mixed, among obstacles; ways to
#: choose sub-goals.
ALPHA, SQUARE, COVERAGE = EXPERIMENTS = ("patrol_alpha", "patrol_square", "coverage_sources")
#: Number of keys of laps, from the seeds 1, 2, …; number of laps: as many as the paper's figures show.
_LAP_KEYS, _LAPS = 60, 12

#: Value of a mission; None without one.
Value = Callable[[Row], float | None]


@dataclass(frozen=True)
class Cell:
    """A cell of an experiment.

    Attributes
    ----------
    case
        Name of its case.
    value
        Value of the parameter; empty without one.
    rows
        Its missions that did not fail, by seed.
    """

    case: str
    value: str
    rows: Mapping[int, Row]

    def values(self, value: Value) -> list[float]:
        """Values of the missions that have one."""
        return [found for row in self.rows.values() if (found := value(row)) is not None]

    def mean(self, value: Value) -> Mean | None:
        """Mean over the missions that have the value."""
        return Mean.of(self.values(value))


@dataclass(frozen=True)
class Study:
    """The results of an experiment: version of the program, seeds as text, cells in the order of the experiment."""

    program: str
    seeds: str
    cells: list[Cell]

    @staticmethod
    def of(results: Results) -> "Study":
        """Study of an experiment with at most one parameter."""
        cells = [Cell(cell.case, cell.text, results.finished(n)) for n, cell in enumerate(results.cells)]
        return Study(results.program, results.seeds, cells)

    def cell(self, case: str, value: str = "") -> Cell | None:
        """Cell of a case with a value of its parameter."""
        return next((cell for cell in self.cells if (cell.case, cell.value) == (case, value)), None)


@dataclass
class Evidence:
    """Studies by the name of their experiment, one of `EXPERIMENTS`; missing ones are noted."""

    studies: dict[str, Study] = field(default_factory=dict)


def visits(row: Row) -> dict[str, Any] | None:
    """Waypoints of the first robot that visits some."""
    return next((robot["waypoints"] for robot in row["robots"] if robot["waypoints"] is not None), None)


def lap(row: Row, which: str, figure: str) -> float | None:
    """Figure of the first robot's laps, ``planned`` or ``driven``."""
    visit = visits(row)
    found = visit and visit[which]
    return found[figure] if found else None


def covered(row: Row, way: float) -> float | None:
    """Covered part of the reachable area after a distance driven (m)."""
    parts = row["coverage"]["by_way"] if row["coverage"] else []
    return next((part["coverable_fraction"] for part in parts if part["way_m"] == way), None)


def least_error(row: Row, horizon: float, *, knows_method: bool) -> float | None:
    """Smallest mean error (m) of the methods of prediction at this horizon (s), that know the method of the goals or not."""
    errors = (
        prediction["mean_m"]
        for prediction in row["predictions"]
        if prediction["horizon_s"] == horizon and prediction["method"].endswith("_key") == knows_method
    )
    return min((error for error in errors if error is not None), default=None)


@dataclass(frozen=True)
class Laps:
    """Laps of a case of the paper under many keys, without a robot.

    Attributes
    ----------
    v
        Speed along the contour (m/s).
    values
        Values under each key, by name.
    """

    v: float
    values: dict[str, list[float]]


def laps(scenario: str, alpha: float, t_max: float | None = None) -> Laps:
    """Laps of a built-in scenario with this width (m) and time of a lap (s; that of the scenario if None)."""
    mission = {"alpha": alpha, "preset": '"paper_fit"'} | ({} if t_max is None else {"t_max": t_max})
    overrides = [f"processes.patrol.params.mission.{key}={value}" for key, value in mission.items()]
    found = [lab.patrol_laps(scenario, overrides, seed, _LAPS) for seed in range(1, _LAP_KEYS + 1)]
    names = ("speed", "length", "mae", "maa", "maa_folded", "andc")
    columns = zip(*(values for _, values in found), strict=True)
    return Laps(found[-1][0], {name: list(column) for name, column in zip(names, columns, strict=True)})
