#!/usr/bin/env python3
"""Cost of a planner's turn in Python beside the same planner in Rust.

usage: python_turn.py RUST_PLANNER [--runs N]

    cargo build --release -p benchmarks --bin go_to_exit
    pip install protean-robotics            # or target/wheels/*.whl
    benchmarks/python_turn.py target/release/go_to_exit

Both drive a robot through the same mission, as processes, one run after the other. A turn is the time from receiving the state to
sending the command, as every log measures it ("planner step"). The function alone is measured within its calls.
"""

import argparse
import statistics
import sys
import tempfile
import time
from pathlib import Path

import protean_robotics as pr

MISSION = """
[world.map.vector]
bounds = {{ min = [0.0, 0.0], max = [60.0, 4.0] }}
[rules]
exits = [{{ circle = {{ center = [59.0, 2.0], radius = 0.2 }} }}]
time_limit = 120.0
[[robots]]
name = "robot"
team = "evader"
start = {{ x = 1.0, y = 2.0, theta = 0.3 }}
[[processes]]
name = "planner"
command = {command}
robots = ["robot"]
"""


@pr.planner
def steer(robot: pr.Robot, world: pr.World, map: pr.Map) -> tuple[float, float]:
    return pr.go_to(robot, world.exits[0])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rust_planner", type=Path)
    parser.add_argument("--runs", type=int, default=5)
    args = parser.parse_args()
    folder = Path(tempfile.mkdtemp())
    commands = {
        "Python": [sys.executable, str(Path(__file__).resolve())],
        "Rust": [str(args.rust_planner.resolve())],
    }
    for name, command in commands.items():
        (folder / f"{name}.toml").write_text(MISSION.format(command=str(command).replace("'", '"')))
    steps: dict[str, list[dict[str, float]]] = {name: [] for name in commands}
    digests = set()
    for _ in range(args.runs):
        for name in commands:
            run = pr.run(folder / f"{name}.toml", allow_external=True, out=folder / f"{name}.mcap", force=True)
            steps[name].append(run.summary["latency_us"]["planner step"])
            digests.add(run.digest)
    times: list[int] = []

    @pr.planner
    def timed(robot: pr.Robot, world: pr.World, map: pr.Map) -> tuple[float, float]:
        begin = time.perf_counter_ns()
        command = pr.go_to(robot, world.exits[0])
        times.append(time.perf_counter_ns() - begin)
        return command

    pr.run(folder / "Python.toml", in_process=True, planners={"planner": timed})
    function = statistics.median(times) / 1000
    print(f"one digest in Python and Rust: {len(digests) == 1}")
    for name, found in steps.items():
        p50, p99 = (statistics.median(step[key] for step in found) for key in ("p50", "p99"))
        print(f"{name:6}  turn p50 {p50:6.1f} us, p99 {p99:6.1f} us")
    python = statistics.median(step["p50"] for step in steps["Python"])
    rust = statistics.median(step["p50"] for step in steps["Rust"])
    print(f"function in Python alone: {function:.1f} us; turn beyond it {python - function:.1f} us")
    print(f"Python beyond Rust: {python - rust:.1f} us")


if __name__ == "__main__":
    import os

    if "PROTEAN_CONFIG" in os.environ:
        pr.serve(steer)
    main()
