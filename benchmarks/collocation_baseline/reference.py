"""Stored times of a file of instances: the best of several starts, by FATROP or, where it fails, by IPOPT."""

import json
import pathlib
import time as clock

from . import instance, plan
from .program import SOLVERS

STARTS, INTERVALS = 8, 160


def path_of(instances):
    return pathlib.Path(instances).with_suffix(".reference.json")


def load(instances):
    """Times by id; empty if there is no file."""
    try:
        entries = json.loads(path_of(instances).read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    return {entry["id"]: entry["t_s"] for entry in entries}


def make(instances, budget_s, say):
    """Write the file. Instances that the budget of CPU time does not reach are left out."""
    begin = clock.process_time()
    effort = plan.Effort(INTERVALS, STARTS)
    entries = []
    for raw in instance.load(instances):
        if clock.process_time() - begin > budget_s:
            say(f"out of time: {len(entries)} instances")
            break
        problem = instance.parse(raw)
        result = plan.solve(problem, SOLVERS, effort)
        if not result["honest"]:
            say(f"{problem.id}: no valid solution")
            continue
        entries.append({"id": problem.id, "t_s": round(result["t_s"], 7)} | {key: result[key] for key in ("solver", "start")})
        say(f"{problem.id}: {result['t_s']:.5f} s, {result['solver']}, {result['start']}, {result['cpu_ms']:.0f} ms CPU")
    text = "[\n" + ",\n".join(json.dumps(entry) for entry in entries) + "\n]\n"
    path_of(instances).write_text(text, encoding="utf-8")
