#!/usr/bin/env python3
"""Drake's `GcsTrajectoryOptimization` as a baseline of `protean plan` where speed and turn rate may step.

    python3 -m venv /tmp/drake
    /tmp/drake/bin/pip install drake==1.51.1
    /tmp/drake/bin/python benchmarks/drake_baseline.py benchmarks/instances/base_small.json \\
        --protean target/release/protean

A graph of convex sets minimises the length of a polyline through convex regions of the free board, that is
the time of a robot that turns in no time: a bound below of the problem that `protean plan` solves, so the
comparison favours Drake. The regions are made by Iris from a grid of seeds that they cover in the end; their
CPU time is stated apart, because a board that does not change needs them once.
"""

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse  # noqa: E402
import sys  # noqa: E402
import time as clock  # noqa: E402

import numpy as np  # noqa: E402
from collocation_baseline import instance, protean  # noqa: E402

try:
    from pydrake.geometry.optimization import GraphOfConvexSetsOptions, HPolyhedron, Hyperellipsoid, Iris, IrisOptions, Point
    from pydrake.planning import GcsTrajectoryOptimization
except ModuleNotFoundError as error:
    sys.exit(f"{error}; pip install drake")

# Lengths are in hundreds of pixels, as the solvers like numbers of about 1.
UNIT = 100.0
# Distances of the seeds: the second one where the regions of the first do not connect the ends.
PITCHES = (0.4, 0.2)


def regions(problem, pitch):
    """Convex regions that cover the seeds of the free board and both ends."""
    x0, y0, x1, y1 = np.array(problem.bounds) / UNIT
    board = HPolyhedron.MakeBox([x0, y0], [x1, y1])
    centres, radii = problem.centres / UNIT, problem.radii / UNIT
    obstacles = [Hyperellipsoid.MakeHypersphere(r, centre) for centre, r in zip(centres, radii)]
    grid = np.stack(np.meshgrid(np.arange(x0 + pitch / 2, x1, pitch), np.arange(y0 + pitch / 2, y1, pitch)), -1)
    seeds = [np.array(problem.start) / UNIT, np.array(problem.goal) / UNIT, *grid.reshape(-1, 2)]
    away = lambda seed: np.hypot(*(centres - seed).T) - radii
    seeds = [seed for seed in seeds if not len(radii) or away(seed).min() > 0.01]
    found, options = [], IrisOptions()
    options.require_sample_point_is_contained = True
    for seed in seeds:
        if not any(region.PointInSet(seed, 1e-6) for region in found):
            try:
                found.append(Iris(obstacles, seed, board, options))
            except RuntimeError:
                continue  # its solver gave up near a disc
    return found


def solve(problem, repeat):
    for pitch in PITCHES:
        begin = clock.process_time()
        sets = regions(problem, pitch)
        spent = {"regions_ms": 1e3 * (clock.process_time() - begin), "regions": len(sets)}
        tries = [through(problem, sets) for _ in range(repeat)]
        trajectory, result = tries[0][:2]
        spent["cpu_ms"] = min(each[2] for each in tries)
        if result.is_success():
            break
    if not result.is_success():
        return {"honest": False, "status": str(result.get_solution_result()), **spent}
    knots = np.array([trajectory.value(t).ravel() for t in np.linspace(trajectory.start_time(), trajectory.end_time(), 4001)])
    length = float(np.sum(np.hypot(*np.diff(knots, axis=0).T)))
    return {"honest": True, "t_s": length * UNIT / problem.v_max, **spent}


def through(problem, sets):
    """The trajectory through the regions, the result and the CPU time in milliseconds."""
    begin = clock.process_time()
    planner = GcsTrajectoryOptimization(2)
    free = planner.AddRegions(sets, 1, h_min=0.0, h_max=1e3)
    source = planner.AddRegions([Point(np.array(problem.start) / UNIT)], 0)
    target = planner.AddRegions([Point(np.array(problem.goal) / UNIT)], 0)
    planner.AddEdges(source, free)
    planner.AddEdges(free, target)
    planner.AddPathLengthCost(1.0)
    options = GraphOfConvexSetsOptions()
    options.convex_relaxation = True
    options.max_rounded_paths = 10
    trajectory, result = planner.SolvePath(source, target, options)
    return trajectory, result, 1e3 * (clock.process_time() - begin)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("instances", metavar="INSTANCES.json")
    parser.add_argument("--protean", metavar="PROGRAM", required=True)
    parser.add_argument("--limit", type=int, metavar="N", help="only the first N instances")
    parser.add_argument("--repeat", type=int, default=2, metavar="K", help="least CPU time of K runs (default 2)")
    args = parser.parse_args()
    rows = []
    for raw in instance.load(args.instances, args.limit):
        problem = instance.parse(raw)
        if problem.has_inertia:
            sys.exit(f"{problem.id} has limited accelerations, which a graph of convex sets cannot state")
        ours = protean.judged(problem, protean.run(args.protean, "bspline", raw, args.repeat))
        theirs = solve(problem, args.repeat)
        print(problem.id, {**theirs, "ours_s": ours.get("t_s"), "ours_ms": ours.get("cpu_ms")}, file=sys.stderr, flush=True)
        if theirs["honest"] and ours["honest"]:
            rows.append((theirs["cpu_ms"], theirs["regions_ms"], ours["cpu_ms"], ours["t_s"] / theirs["t_s"] - 1.0))
    if not rows:
        sys.exit("no instance was solved by both")
    graph, sets, cpu, gap = np.array(rows).T
    print(f"{len(rows)} instances; Drake's graph {np.median(graph):.0f} ms, its regions {np.median(sets):.0f} ms, ours {np.median(cpu):.2f} ms")
    print(f"graph / ours {np.median(graph / cpu):.0f}, our time above Drake's length / v_max: {100 * np.median(gap):.3f} % (largest {100 * gap.max():.3f} %)")


if __name__ == "__main__":
    main()
