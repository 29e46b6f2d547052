"""Coverage of a workplace by sub-goals."""

import json
import os
from collections.abc import Mapping
from typing import Any

from . import _core
from ._arguments import checked
from ._program import overrides

Plan = _core.coverage.Plan


@checked
def plan(
    scenario: str | os.PathLike[str] = "coverage_open",
    *,
    process: str | None = None,
    loops: int | None = None,
    goals: int | None = None,
    length: float | None = None,
    seed: int | None = None,
    set: Mapping[str, Any] | None = None,
    allow_outside: bool = False,
) -> dict[str, Any]:
    """Plans the coverage of a scenario, without a run: of a robot that drives straight from sub-goal to sub-goal.

    Parameters
    ----------
    scenario
        Name of a built-in scenario, or path of a scenario file.
    process
        Name of the process; required if several cover.
    loops
        Number of large loops, at most 100 000; 1 if `goals` and `length` are None too.
    goals
        Number of sub-goals, at most 10 million, in place of loops.
    length
        Length of the path through the sub-goals (m), in place of loops.
    seed
        Seed of the run; the scenario's if None.
    set
        Values that replace those of the scenario, by their dotted keys.
    allow_outside
        True if the scenario may use files outside its folder.

    Returns
    -------
    dict
        Process, robot, `start`, `rectangles`, `bridges`, `tour`, `sub_goals`, and their `coverage`: the share of the cells
        that the robot's body can cover, of cells with a sub-goal (`goals`), cells with a point of the path (`path`), and
        cells whose centre the robot's disc sweeps (`disc`, cells of 0.1 m).

    Raises
    ------
    InvalidInput
        A scenario without a coverage, or with several; more than one of `loops`, `goals` and `length`.

    Examples
    --------
    >>> import protean_robotics as pr
    >>> found = pr.coverage.plan("coverage_case1", goals=20)
    >>> len(found["rectangles"]), len(found["sub_goals"])
    (4, 20)
    """
    source = (os.fspath(scenario), overrides(set), seed, allow_outside, process)
    found: dict[str, Any] = json.loads(_core.plan_coverage(source, loops, goals, length))
    return found


__all__ = ["Plan", "plan"]
