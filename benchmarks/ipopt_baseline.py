#!/usr/bin/env python3
"""IPOPT as a baseline of `protean plan` for minimum-time planning.

    python3 -m venv /tmp/ipopt
    /tmp/ipopt/bin/pip install -r benchmarks/ipopt_baseline/requirements.txt
    cargo build --release
    /tmp/ipopt/bin/python benchmarks/ipopt_baseline.py benchmarks/instances/base_small.json \\
        --protean target/release/protean --method bspline

Without `--protean`, IPOPT alone. What is solved, how it is timed and looked at, and the fields of
the files: `benchmarks/ipopt_baseline/README.md`.
"""

import os

# One thread; set before libraries read it.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse  # noqa: E402
import json  # noqa: E402
import sys  # noqa: E402

try:
    from ipopt_baseline import compare, instance, plan
    from ipopt_baseline.collocation import Options
except ModuleNotFoundError as error:
    sys.exit(f"{error}; pip install -r benchmarks/ipopt_baseline/requirements.txt")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("instances", metavar="INSTANCES.json")
    parser.add_argument("--limit", type=int, metavar="N", help="only the first N instances")
    parser.add_argument("--protean", metavar="PROGRAM", help="protean to compare with")
    parser.add_argument("--method", default="bspline", help="its method (default bspline)")
    parser.add_argument("--json", metavar="OUT", help="write everything to this file, too")
    parser.add_argument("--n", type=int, default=80, help="intervals (default 80)")
    parser.add_argument("--scheme", choices=("auto", "trapezoid", "gauss"), default="auto",
                        help="auto: gauss where accelerations or wheels are limited")
    parser.add_argument("--guess", choices=("astar", "tangent"), default="astar",
                        help="tangent: begin from the plan of protean (its CPU time is added)")
    parser.add_argument("--guess-method", metavar="METHOD", default="tangent",
                        help="protean's method for --guess tangent (default tangent)")
    parser.add_argument("--reverse", action="store_true", help="may drive backwards")
    parser.add_argument("--repairs", type=int, default=3,
                        help="solves more where a disc is entered between nodes (default 3)")
    parser.add_argument("--starts", type=int, default=1, help="corridors to try (default 1)")
    parser.add_argument("--refine", action="store_true",
                        help="once more with 2 N intervals and free durations")
    args = parser.parse_args()
    if args.limit is not None and args.limit < 1:
        parser.error("--limit: expected 1 or more")
    if args.n < 2 or args.starts < 1 or args.repairs < 0:
        parser.error("expected --n of 2 or more, --starts of 1 or more, --repairs of 0 or more")
    if args.guess == "tangent" and not args.protean:
        parser.error("--guess tangent needs --protean")
    return args


def main():
    args = arguments()
    say = lambda text: print(text, file=sys.stderr, flush=True)
    try:
        raws = instance.load(args.instances, args.limit)
    except (OSError, ValueError) as error:
        sys.exit(f"{args.instances}: {error}")
    plans, hints, notes = {}, {}, []
    if args.protean:
        say(f"{args.protean} plan, {args.method} ...")
        plans, note = compare.run_protean(args.protean, args.method, args.instances, args.limit)
        notes += [note] if note else []
    if args.guess == "tangent":
        hints, note = compare.run_protean(args.protean, args.guess_method, args.instances, args.limit)
        notes += [note] if note else []

    options = Options(intervals=args.n, scheme=args.scheme, reverse=args.reverse)
    effort = plan.Effort(repairs=args.repairs, starts=args.starts, refine=args.refine)
    rows = []
    try:
        for done, raw in enumerate(raws, start=1):
            name = str(raw.get("id"))
            try:
                problem = instance.parse(raw)
            except instance.Refused as refusal:
                notes.append(f"{name} {refusal}")
                continue
            ours, hint = plans.get(name), hints.get(name)
            bound, whose = problem.lower_bound_s, "file"
            if bound is None:
                bound, whose = (ours or {}).get("lower_bound_s"), "protean"
            row = {"id": name, "lower_bound_s": bound, "bound_of": whose if bound else None}
            if args.guess == "tangent" and not (hint or {}).get("samples"):
                notes.append(f"{name}: no plan to begin from, A* instead")
                hint = None
            row["ipopt"] = result = plan.solve(problem, options, effort, hint)
            if ours is not None:
                row["protean"] = compare.judge_protean(problem, ours)
            rows.append(row)
            t_s = result.get("t_s")
            say(
                f"{done}/{len(raws)} {name}: {'honest' if result['honest'] else 'not honest'}, "
                f"{result['status']}, {'-' if t_s is None else format(t_s, '.4f')} s, "
                f"{result['cpu_ms']:.0f} ms CPU {'; '.join(result.get('reasons', []))}"
            )
    except KeyboardInterrupt:
        notes.append("interrupted: the figures are of what was done")

    summary = compare.summarise(rows) if rows else None
    print(f"{args.instances}: {len(rows)} of {len(raws)} instances")
    if rows:
        print(compare.table(summary))
    for note in notes:
        print(f"note: {note}")
    if args.json:
        document = {"settings": vars(args), "notes": notes, "summary": summary, "instances": rows}
        with open(args.json, "w", encoding="utf-8") as file:
            json.dump(document, file, indent=1)
            file.write("\n")
    if not rows:
        sys.exit(1)


if __name__ == "__main__":
    main()
