"""Single plans of the RRT* planners in a static world: `plans.csv`."""

import csv
import io
from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from .._core import lab
from .._errors import InvalidInput

#: Iterations of a plan: those after which the paper stopped searching on arcs.
ITERATIONS = 5000


@dataclass(frozen=True)
class Plan:
    """One plan.

    Attributes
    ----------
    case
        Planner: the name of a case.
    scene
        Positions of the Police: ``start``, as at the start of a game, or ``random``.
    seed
        Seed of the plan, and of the scene if it is random.
    iterations
        Number of iterations.
    found
        True if a path to the exit was found.
    length_m
        Length of the path (m).
    closest_m
        Smallest distance of the path from any pursuer (m).
    shortest_m, shortest_closest_m
        Both of the shortest path (m).
    """

    case: str
    scene: str
    seed: int
    iterations: int
    found: bool
    length_m: float | None
    closest_m: float | None
    shortest_m: float | None
    shortest_closest_m: float | None


#: Columns of the file.
_COLUMNS = [field.name for field in fields(Plan)]


def make(seed: int) -> list[Plan]:
    """Plans with every planner, with the Police at their starts and again at random free positions."""
    return [
        Plan(case, scene, seed, ITERATIONS, path is not None, *(path or (None, None)), *(shortest or (None, None)))
        for case, scene, path, shortest in lab.single_plans(seed, ITERATIONS)
    ]


def read(path: Path) -> list[Plan]:
    """Plans of a file; none if there is none."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        return []
    table = csv.DictReader(text.splitlines())
    if list(table.fieldnames or []) != _COLUMNS:
        raise InvalidInput(f"{path}:1: the columns are {table.fieldnames}: expected a table of plans: {_COLUMNS}")
    found = []
    for line, row in enumerate(table, 2):
        try:
            numbers = [float(row[name]) if row[name] else None for name in _COLUMNS[5:]]
            is_found = {"true": True, "false": False}[row["found"]]
            found.append(Plan(row["case"], row["scene"], int(row["seed"]), int(row["iterations"]), is_found, *numbers))
        except (KeyError, TypeError, ValueError) as error:
            raise InvalidInput(f"{path}:{line}: {error!r}: expected a table of plans") from error
    return found


def table(plans: Iterable[Plan]) -> bytes:
    """Plans as a file, in the order of the seeds."""
    out = io.StringIO()
    writer = csv.DictWriter(out, _COLUMNS, lineterminator="\n")
    writer.writeheader()
    for plan in sorted(plans, key=lambda plan: plan.seed):
        writer.writerow(asdict(plan) | {"found": str(plan.found).lower()})
    return out.getvalue().encode()
