"""One instance from the guess to the looked-at result, with the CPU time of every phase."""

import time as clock
from dataclasses import dataclass, replace

import numpy as np

from . import check, guess
from .collocation import Program

# Growth of a disc in addition to its penetration, in pixels.
REPAIR_PX = 0.02


@dataclass
class Effort:
    """Effort of planning."""

    # Number of further solves, each with the penetrated discs grown.
    repairs: int = 3
    # Guesses through different corridors; the best honest solution counts.
    starts: int = 1
    # Solve the best again with twice as many intervals, in parts with free durations.
    refine: bool = False


def solve(instance, options, effort, hint=None):
    """A dictionary of the result. `hint` is a plan with samples as the first guess instead of A*."""
    spent = {"guess_ms": 0.0, "build_ms": 0.0, "solve_ms": 0.0}
    guesses = []
    begin = clock.process_time()
    if hint is not None:
        guesses.append(guess.from_samples(instance, hint["samples"], options.intervals))
        spent["guess_ms"] += float(hint.get("cpu_ms") or 0.0)
    paths = []
    while len(paths) < effort.starts and (hint is None or effort.starts > 1):
        path = guess.grid_path(instance, paths)
        if path is None:
            break
        paths.append(path)
        states, time = guess.states(instance, path, options.intervals)
        guesses.append((states, time))
        if effort.starts > 1 and guess.turned_other_way(instance, states) is not None:
            guesses.append((guess.turned_other_way(instance, states), time))
    spent["guess_ms"] += 1e3 * (clock.process_time() - begin)
    if not guesses:
        return {"status": "no path on a grid", "honest": False, **totals(spent)}

    program = Program(instance, options)
    spent["build_ms"] += program.build_ms
    found = [repaired(program, states, time, effort, spent) for states, time in guesses]
    best = min(found, key=rank)
    if effort.refine:
        best = min([best, *refined(instance, options, found, effort, spent)], key=rank)
    solution, finding = best
    return {
        "status": solution.status,
        "honest": finding.honest,
        "reasons": finding.reasons,
        "t_s": finding.time,
        "iterations": solution.iterations,
        "max_penetration_px": float(finding.penetration.max(initial=0.0)),
        **totals(spent),
    }


def refined(instance, options, found, effort, spent):
    """The two best again with twice as many intervals, then with independent durations."""
    finer = replace(options, intervals=2 * options.intervals, barrier=1e-4, max_iter=300)
    programs = [Program(instance, finer)]
    if options.intervals % 4 == 0:
        programs.append(Program(instance, replace(finer, segments=options.intervals // 4)))
    spent["build_ms"] += sum(program.build_ms for program in programs)
    better = []
    for solution, _ in sorted(found, key=rank)[:2]:
        states, durations = solution.refined
        for program in programs:
            solution, finding = repaired(program, states, durations, effort, spent)
            better.append((solution, finding))
            if solution.converged:
                states, durations = solution.states, solution.durations
    return better


def repaired(program, states, time, effort, spent):
    """A solution and its finding; discs penetrated between nodes are grown, and the program is solved again."""
    grown = np.zeros(len(program.instance.radii))
    for attempt in range(effort.repairs + 1):
        solution = program.solve(states, time, grown)
        spent["solve_ms"] += solution.solve_ms
        if solution.status == "User_Requested_Stop":
            raise KeyboardInterrupt
        finding = check.look(program.instance, solution)
        entered = finding.penetration > program.instance.millimetre
        if not solution.converged or not entered.any():
            break
        grown[entered] += finding.penetration[entered] + REPAIR_PX
        states, time = solution.states, solution.durations
    return solution, finding


def rank(found):
    solution, finding = found
    return (not finding.honest, not solution.converged, finding.time)


def totals(spent):
    return {**spent, "cpu_ms": sum(spent.values())}
