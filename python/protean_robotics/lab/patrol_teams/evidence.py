"""Our results: missions of teams around contours and on a graph, of a team that loses a guard, of an observer, of adversaries."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from statistics import fmean
from typing import Any

from ..results import Results, Row

#: Names of the experiments: teams around contours; a guard fails; strategies on a graph; an observer of one robot; attacks.
TEAM, FAILURE, STRATEGIES, PREDICTABILITY, ATTACKS = EXPERIMENTS = (
    "patrol_team",
    "patrol_failure",
    "patrol_strategies",
    "patrol_predictability",
    "patrol_attacks",
)
#: Methods of the adversaries.
METHODS = ("random", "history", "statistical", "best_response")
#: Time of a lap in both experiments (s).
LAP_S = 120.0


@dataclass(frozen=True)
class Cell:
    """A cell of an experiment.

    Attributes
    ----------
    case
        Name of its case.
    contour
        Name of the contour; empty without this parameter.
    guards
        Number of guards.
    rows
        Its missions that did not fail, by seed.
    strategy
        Name of the strategy; empty without this parameter.
    duration
        Duration of an attack (s); 0 without this parameter.
    """

    case: str
    contour: str
    guards: int
    rows: Mapping[int, Row]
    strategy: str = ""
    duration: float = 0.0

    def worst(self) -> list[float]:
        """Longest time without a visit of a place, of each mission with one (s)."""
        return self._values("worst_idleness_s")

    def mean(self) -> list[float]:
        """Mean time since the last visit of a place, of each mission with one (s)."""
        return self._values("mean_idleness_s")

    def interval(self) -> list[float]:
        """Mean time between two visits of a node, of each mission with one (s)."""
        return self._values("mean_interval_s")

    def errors(self) -> dict[float, float]:
        """Mean error (m) of the observer's best method, by horizon (s)."""
        found: dict[float, dict[str, list[float]]] = {}
        for row in self.rows.values():
            for entry in row["predictions"]:
                methods = found.setdefault(entry["horizon_s"], {})
                methods.setdefault(entry["method"], []).append(entry["mean_m"])
        return {horizon: min(map(fmean, methods.values())) for horizon, methods in found.items()}

    def attacks(self, method: str) -> tuple[int, int]:
        """Detected and all attacks of an adversary, of all missions."""
        found = [attacker for row in self.rows.values() for attacker in row["attacks"] if attacker["method"] == method]
        return sum(attacker["detected"] for attacker in found), sum(attacker["attacks"] for attacker in found)

    def nearest(self) -> list[float]:
        """Least distance of two guards along the contour, of each mission with one (m)."""
        return self._values("nearest_m")

    def _values(self, figure: str) -> list[float]:
        found = (patrol[figure] for row in self.rows.values() for patrol in row["patrols"])
        return [value for value in found if value is not None]

    @property
    def share_s(self) -> float:
        """Time of a lap by the number of guards (s)."""
        return LAP_S / self.guards


@dataclass(frozen=True)
class Study:
    """The results of an experiment.

    Attributes
    ----------
    program
        Version of the program.
    seeds
        The seeds, as text.
    cells
        Cells in the order of the experiment.
    lengths
        Length of each contour (m), by name.
    """

    program: str
    seeds: str
    cells: list[Cell]
    lengths: Mapping[str, float] = field(default_factory=dict)

    @staticmethod
    def of(results: Results) -> "Study":
        """Study of one of the experiments; four guards where their number is no parameter."""
        cells = []
        for number, cell in enumerate(results.cells):
            values = dict(zip(results.parameters, cell.values, strict=True))
            found = results.finished(number)
            contour, strategy = (values.get(name, "") for name in ("contour", "strategy"))
            guards, duration = values.get("guards", 4), values.get("duration", 0.0)
            cells.append(Cell(cell.case, contour, guards, found, strategy, duration))
        levels = results.experiment.get("parameters", {}).get("contour", {}).get("levels", {})
        lengths = {name: _length(level) for name, level in levels.items()}
        return Study(results.program, results.seeds, cells, lengths)


def _length(level: dict[str, Any]) -> float:
    """Length of the closed contour that a level sets (m)."""
    corners = level["processes"]["patrol"]["params"]["mission"]["contour"]
    return math.fsum(math.dist(a, b) for a, b in pairwise([*corners, corners[0]]))


@dataclass
class Evidence:
    """Studies by the name of their experiment, one of `EXPERIMENTS`; missing ones are noted."""

    studies: dict[str, Study] = field(default_factory=dict)
