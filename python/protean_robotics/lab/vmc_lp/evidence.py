"""Published numbers, and our results for them."""

from dataclasses import dataclass, field
from typing import NamedTuple

from ..results import Results, Row
from ..statistics import BySeed

#: Names of the experiments of Table 2, and of Tables 3 and 4.
SENSITIVITY, VERSUS = EXPERIMENTS = ("vmc_lp_sensitivity", "vmc_lp_tables_3_4")
#: Number of runs of every count of Table 2.
RUNS = 500


class Setting(NamedTuple):
    """A setting of Table 2: name in the experiment, title, short name for figures, failed runs."""

    name: str
    title: str
    short: str
    failed: int


class Sensitivity(NamedTuple):
    """A row of Table 2: a parameter, whether the report calls it sensitive, two settings, whether LP has it, too."""

    parameter: str
    sensitive: bool
    settings: tuple[Setting, Setting]
    of_lp: bool = True

    @property
    def word(self) -> str:
        """The report's word for it."""
        return "sensitive" if self.sensitive else "less sensitive"

    @property
    def change(self) -> float:
        """Published change of the share of failed runs."""
        first, second = self.settings
        return (second.failed / RUNS) - (first.failed / RUNS)


#: Table 2.
TABLE_2 = (
    Sensitivity(
        "control points", True, (Setting("control_points_5", "5", "5 cp", 29), Setting("control_points_8", "8", "8 cp", 7))
    ),
    Sensitivity("degree", False, (Setting("degree_4", "4", "deg 4", 2), Setting("degree_6", "6", "deg 6", 5))),
    Sensitivity("nodes", True, (Setting("nodes_10", "10", "N 10", 20), Setting("nodes_15", "15", "N 15", 6))),
    Sensitivity(
        "reference point",
        True,
        (
            Setting("reference_1800", "−(1800, 1800) px", "ref 1.8k", 6),
            Setting("reference_18000", "−(18000, 18000) px", "ref 18k", 39),
        ),
        of_lp=False,
    ),
    Sensitivity(
        "initial angle",
        True,
        (Setting("angle_0_90", "0 … 90°", "0–90°", 25), Setting("angle_40_45", "40 … 45°", "40–45°", 6)),
    ),
    Sensitivity(
        "obstacles",
        True,
        (Setting("obstacles_1_10", "1 … 10", "1–10", 2), Setting("obstacles_30_40", "30 … 40", "30–40", 51)),
    ),
    Sensitivity(
        "radius",
        True,
        (Setting("radius_5_15", "5 … 15 px", "r 5–15", 6), Setting("radius_20_30", "20 … 30 px", "r 20–30", 125)),
    ),
)


class Test(NamedTuple):
    """One test of Tables 3 and 4: CPU times (s) and times to drive (s), of LP and VMC."""

    cpu: tuple[float, float]
    time: tuple[float, float]


#: Table 3: one planning horizon.
TABLE_3 = (
    Test((3.69, 8.08), (29.24, 31.56)),
    Test((2.16, 3.44), (30.29, 30.23)),
    Test((4.81, 32.28), (38.41, 39.54)),
    Test((4.72, 5.44), (39.22, 39.54)),
    Test((3.11, 5.10), (36.17, 37.18)),
    Test((5.03, 9.51), (33.13, 34.07)),
)
#: Table 4, first planning.
TABLE_4_FIRST = (
    Test((3.29, 9.23), (31.28, 31.83)),
    Test((4.25, 6.33), (30.45, 29.79)),
    Test((4.05, 6.35), (29.40, 30.78)),
    Test((3.97, 6.45), (34.75, 36.13)),
)
#: Table 4, second planning.
TABLE_4_SECOND = (
    Test((2.67, 8.42), (20.41, 22.05)),
    Test((2.41, 4.15), (19.23, 18.39)),
    Test((2.78, 6.81), (18.80, 20.64)),
    Test((2.07, 4.69), (21.82, 22.38)),
)


class Plan(NamedTuple):
    """Figures of a plan.

    Attributes
    ----------
    unsolvable
        True if the problem has no solution.
    time
        Duration of the plan (s); None without a valid one.
    cpu_ms
        CPU time (ms).
    """

    unsolvable: bool
    time: float | None
    cpu_ms: float | None

    @staticmethod
    def of(row: Row, cpu_ms: float | None) -> "Plan":
        """Figures of a row."""
        return Plan(row["outcome"] in ("no_path", "infeasible"), row["t_s"] if row["honest"] is True else None, cpu_ms)


@dataclass(frozen=True)
class Study:
    """The results of an experiment with one parameter.

    Attributes
    ----------
    program, seeds
        Version of the program; as text.
    cells
        Plans by seed, by case and value of the parameter.
    """

    program: str = ""
    seeds: str = ""
    cells: dict[tuple[str, str], dict[int, Plan]] = field(default_factory=dict)

    @staticmethod
    def of(results: Results) -> "Study":
        """Study of an experiment."""
        cells: dict[tuple[str, str], dict[int, Plan]] = {}
        for (number, seed), row in results.rows.items():
            cell = results.cells[number]
            plan = Plan.of(row, results.cpu_ms.get((number, seed)))
            cells.setdefault((cell.case, cell.text), {})[seed] = plan
        return Study(results.program, results.seeds, cells)

    def failed_seeds(self, case: str, value: str) -> BySeed | None:
        """Failures among the solvable problems of a case, by seed; None without such problems."""
        plans = self.cells.get((case, value), {})
        return {seed: (int(p.time is None), 1) for seed, p in plans.items() if not p.unsolvable} or None

    def failures(self, case: str, value: str) -> tuple[int, int] | None:
        """Numbers of failed and of solvable problems of a case; None without problems."""
        failed = self.failed_seeds(case, value)
        return None if failed is None else (sum(hits for hits, _ in failed.values()), len(failed))

    def are_same_runs(self, a: str, b: str) -> bool:
        """True if two values are one and the same set of runs: the same problems with the same plans in every case."""

        def runs(value: str) -> dict[str, dict[int, tuple[bool, float | None]]]:
            return {
                case: {seed: plan[:2] for seed, plan in cell.items()}
                for (case, of), cell in self.cells.items()
                if of == value
            }

        return any(runs(a).values()) and runs(a) == runs(b)

    def unsolvable(self, value: str) -> int:
        """Number of problems of a value without a solution."""
        cells = (cell for (_, of), cell in self.cells.items() if of == value)
        return max((sum(plan.unsolvable for plan in cell.values()) for cell in cells), default=0)


@dataclass
class Evidence:
    """Studies by the name of their experiment, one of `EXPERIMENTS`; missing ones are noted."""

    studies: dict[str, Study] = field(default_factory=dict)


def share(count: tuple[int, int]) -> float:
    """Share of hits among all."""
    return count[0] / max(count[1], 1)
