"""One instance from the guess to the looked-at result, with the CPU time of every phase."""

import time as clock
from dataclasses import dataclass

import numpy as np

from . import check, guess
from .program import Shape, program

# Growth of a disc in addition to its penetration, in pixels.
REPAIR_PX = 0.02


@dataclass
class Effort:
    """Effort of planning."""

    intervals: int = 80
    # Guesses; the best valid solution counts.
    starts: int = 1
    # Number of further solves, each with the penetrated discs grown.
    repairs: int = 3
    # Initial barrier parameter.
    barrier: float = 1e-2


def solve(instance, solvers, effort):
    """A dictionary of the result. A start that the first solver does not finish goes to the next one.

    Programs are built once for all instances of a shape: `build_ms` does not count.
    """
    shape = Shape.of(instance, effort.intervals)
    begin = clock.process_time()
    starts = [(each.kind, *each.states(instance, effort.intervals)) for each in guess.guesses(instance, effort.starts)]
    guess_ms = 1e3 * (clock.process_time() - begin)
    build_ms, solve_ms, found = 0.0, 0.0, []
    for kind, states, time in starts:
        for solver in solvers:
            ready = program(solver, shape, effort.barrier)
            build_ms = max(build_ms, ready.build_ms)
            solution, finding, spent = repaired(ready, instance, states, time, effort.repairs)
            solve_ms += spent
            found.append((solution, finding, solver, kind))
            if finding.honest:
                break
    spent = {"guess_ms": guess_ms, "build_ms": build_ms, "solve_ms": solve_ms, "cpu_ms": guess_ms + solve_ms}
    if not found:
        return {"status": "no path on a grid", "honest": False, **spent}
    solution, finding, solver, kind = min(found, key=lambda each: (not each[1].honest, each[1].time))
    return {
        "status": solution.status,
        "honest": finding.honest,
        "reasons": finding.reasons,
        "t_s": finding.time,
        "iterations": solution.iterations,
        "solver": solver,
        "start": kind,
        **spent,
    }


def repaired(ready, instance, states, time, repairs):
    """A solution, its finding and the CPU time; discs penetrated between nodes are grown, and it is solved again."""
    grown = np.zeros(len(instance.radii))
    spent = 0.0
    for _ in range(repairs + 1):
        solution = ready.solve(instance, states, time, grown)
        spent += solution.solve_ms
        if solution.status == "User_Requested_Stop":
            raise KeyboardInterrupt
        finding = check.look(instance, solution)
        entered = finding.penetration > instance.millimetre
        if not solution.converged or not entered.any():
            break
        grown[entered] += finding.penetration[entered] + REPAIR_PX
        states, time = solution.states, solution.time
    return solution, finding, spent
