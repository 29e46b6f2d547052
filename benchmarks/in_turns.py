#!/usr/bin/env python3
"""Speed of missions of `chase` beside another version of the program, in turns.

usage: in_turns.py OLD NEW [--turns N]

OLD and NEW are paths of `protean`. Printed are the ratios of OLD to NEW, median (least to greatest) of the turns: of the wall
time and of the processor time per simulated second. Games of two versions may differ.
"""

import argparse
import json
import os
import resource
import statistics
import subprocess
import tempfile
import time

ROWS = {
    "one thread": ["run", "chase", "--json", "--quiet", "--in-process"],
    "one thread, log": ["run", "chase", "--json", "--quiet", "--in-process", "--out=log.mcap"],
    "processes, log": ["run", "chase", "--json", "--quiet", "--out=log.mcap"],
}
SEEDS = range(1, 6)


def used() -> float:
    own = resource.getrusage(resource.RUSAGE_CHILDREN)
    return own.ru_utime + own.ru_stime


def cost(program: str, words: list[str]) -> tuple[float, float]:
    """Wall time and processor time of the games of all seeds, per simulated second."""
    simulated = wall = processor = 0.0
    for seed in SEEDS:
        with tempfile.TemporaryDirectory() as folder:
            begin, before = time.perf_counter(), used()
            done = subprocess.run(
                [program, *words, f"--seed={seed}"],
                cwd=folder, env=os.environ | {"XDG_RUNTIME_DIR": folder}, capture_output=True, check=True,
            )  # fmt: skip
            wall += time.perf_counter() - begin
            processor += used() - before
            simulated += json.loads(done.stdout)["sim_time_s"]
    return wall / simulated, processor / simulated


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("old", type=os.path.abspath)
    parser.add_argument("new", type=os.path.abspath)
    parser.add_argument("--turns", type=int, default=5)
    arguments = parser.parse_args()
    for name, words in ROWS.items():
        turns = [(cost(arguments.old, words), cost(arguments.new, words)) for _ in range(arguments.turns)]
        ratios = [[old[i] / new[i] for old, new in turns] for i in (0, 1)]
        shown = [f"{statistics.median(all):.2f} ({min(all):.2f} to {max(all):.2f})" for all in ratios]
        fastest = 1.0 / min(new[0] for _, new in turns)
        print(f"{name:16} wall {shown[0]}, processor {shown[1]}; new {fastest:.0f} x real time", flush=True)


if __name__ == "__main__":
    main()
