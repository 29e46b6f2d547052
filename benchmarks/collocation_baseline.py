#!/usr/bin/env python3
"""FATROP and IPOPT as baselines of `protean plan` for minimum-time planning.

    python3 -m venv /tmp/casadi
    /tmp/casadi/bin/pip install -r benchmarks/collocation_baseline/requirements.txt
    cargo build --release
    /tmp/casadi/bin/python benchmarks/collocation_baseline.py compare benchmarks/instances/*.json \\
        --protean target/release/protean

What is solved, how it is timed and looked at, and the fields of the files:
`benchmarks/collocation_baseline/README.md`.
"""

import os

# One thread; set before libraries read it.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse  # noqa: E402
import json  # noqa: E402
import pathlib  # noqa: E402
import sys  # noqa: E402

try:
    from collocation_baseline import compare, instance, reference
    from collocation_baseline.program import SOLVERS
except ModuleNotFoundError as error:
    sys.exit(f"{error}; pip install -r benchmarks/collocation_baseline/requirements.txt")


def count(text):
    if int(text) < 1:
        raise ValueError
    return int(text)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    comparing = commands.add_parser("compare", help="protean, FATROP and IPOPT in turn on every instance; a table")
    comparing.add_argument("instances", metavar="INSTANCES.json", nargs="+")
    comparing.add_argument("--protean", metavar="PROGRAM", help="protean to compare with")
    comparing.add_argument("--method", default="bspline", help="its method (default bspline)")
    comparing.add_argument("--solvers", nargs="*", choices=SOLVERS, default=SOLVERS, help="default: all")
    comparing.add_argument("--limit", type=count, metavar="N", help="only the first N instances of each file")
    comparing.add_argument("--repeat", type=count, default=2, metavar="K",
                           help="plan K times and take the least CPU time, all planners (default 2)")
    comparing.add_argument("--reverse", action="store_true", help="all may drive backwards as quickly as forwards")
    comparing.add_argument("--n", type=count, default=80, help="intervals (default 80)")
    comparing.add_argument("--starts", type=count, default=1, help="guesses to start from (default 1)")
    comparing.add_argument("--repairs", type=int, default=3,
                           help="further solves where a disc is entered between nodes (default 3)")
    comparing.add_argument("--json", metavar="OUT", help="write everything to this file, too")
    referring = commands.add_parser("reference", help="store the best times of eight starts beside the instances")
    referring.add_argument("instances", metavar="INSTANCES.json", nargs="+")
    referring.add_argument("--budget", type=float, default=600.0, metavar="S", help="CPU time per file (default 600 s)")
    return parser.parse_args()


def main():
    args = arguments()
    say = lambda text: print(text, file=sys.stderr, flush=True)
    paths = [path for path in args.instances if not path.endswith(".reference.json")]
    document = {"settings": vars(args), "files": {}}
    table, notes = [compare.HEAD], []
    try:
        for path in paths:
            if args.command == "reference":
                reference.make(path, args.budget, say)
                continue
            found, more = compare.rows(path, args, say)
            summary = compare.summarise(found)
            name = pathlib.Path(path).stem
            table += compare.lines(name, summary)
            notes += more
            document["files"][name] = {"summary": summary, "instances": found}
    except (OSError, ValueError) as error:
        sys.exit(f"{path}: {error}")
    except KeyboardInterrupt:
        notes.append("interrupted: files that were not finished are left out")
    if args.command == "reference":
        return
    print("\n".join(table))
    for note in notes:
        print(f"note: {note}")
    if args.json:
        with open(args.json, "w", encoding="utf-8") as file:
            json.dump(document, file, indent=1)
            file.write("\n")


if __name__ == "__main__":
    main()
