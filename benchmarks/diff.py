#!/usr/bin/env python3
"""CPU time and memory of `protean diff` on logs of one hour, beside reading the logs.

usage: diff.py [PROTEAN]

    cargo build --release -p protean
    benchmarks/diff.py target/release/protean

Two runs of a chase without captures and exits: the second is a repetition, then one with another seed, which differs
from the beginning. `protean info` reads a log once. The ratio is that of the CPU times of `diff` and of reading both
logs.
"""

import argparse
import os
import subprocess
import tempfile
from pathlib import Path

SETTINGS = ("rules.time_limit=3600", "rules.capture.radius=0.01", "world.exits=[]", "log.viewer_rate_hz=0")


def record(program: str, seed: int, log: Path) -> None:
    changes = [word for setting in SETTINGS for word in ("--set", setting)]
    command = [program, "run", "chase", "--in-process", "--quiet", "--seed", str(seed), "--out", str(log), *changes]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def measured(*command: str) -> tuple[float, float]:
    """CPU time (s) and maximum memory (MB) of a command."""
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, _, usage = os.wait4(child.pid, 0)
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", nargs="?", default="protean")
    program = parser.parse_args().program
    with tempfile.TemporaryDirectory() as folder:
        logs = [Path(folder, name) for name in ("a.mcap", "again.mcap", "other.mcap")]
        for log, seed in zip(logs, (1, 1, 2), strict=True):
            record(program, seed, log)
        size = logs[0].stat().st_size / 1e6
        read = [measured(program, "info", str(log))[0] for log in logs]
        print(f"log of {size:.0f} MB, read in {read[0]:.1f} s")
        for name, at in (("repetition", 1), ("other seed", 2)):
            cpu_s, memory_mb = measured(program, "diff", str(logs[0]), str(logs[at]))
            ratio = cpu_s / (read[0] + read[at])
            print(f"{name}: {cpu_s:.1f} s, {ratio:.2f} times reading both, {memory_mb:.0f} MB")


if __name__ == "__main__":
    main()
