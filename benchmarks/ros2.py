#!/usr/bin/env python3
"""Figures of `ros2_bridge` with a node of `rclpy` that steers six robots: speed in lock-step, digests, latency in real time.

    pip install 'ros-kilted-rclpy[fastrtps]' ros-kilted-geometry-msgs ros-kilted-nav-msgs ros-kilted-rosgraph-msgs
    python3 benchmarks/ros2.py target/release/protean --seeds 20 --runs 2 --hogs 3

The program has the feature `ros2`; the interpreter has `rclpy`. The node is `tests/python/ros2_planner.py`: a timer of 20 Hz on simulated
time, in lock-step; an answer to each odometry in real time. Each run has a node of its own. With `--hogs N`, N processes that compute
without end run beside the second half of the runs.
"""

import argparse
import collections
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

NODE = pathlib.Path(__file__).resolve().parent.parent / "tests/python/ros2_planner.py"
ROBOTS = [f"robot_{number}" for number in range(1, 7)]
SCENARIO = """
title = "Six robots that a node of ROS 2 steers"
description = "They drive in circles."
[world.map.vector]
bounds = { min = [-20.0, -20.0], max = [20.0, 20.0] }
[[robots]]
name = "robot"
team = "neutral"
count = 6
random_start = {}
radius = 0.2
limits = { v_max = 1.0, omega_max = 40.0 }
[[processes]]
name = "bridge"
kind = "ros2_bridge"
team = "neutral"
grouping = "together"
[processes.params]
answer_timeout_s = 30.0
start_timeout_s = 60.0
"""


def protean(args, *words):
    return subprocess.run([args.program, *words], check=True, capture_output=True, text=True).stdout


def run(args, folder, mode, *words):
    """The summary of a run with a node of its own."""
    domain = str(1 + os.getpid() % 100)
    environment = os.environ | {"ROS_DOMAIN_ID": domain, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "HOME": str(folder)}
    node = subprocess.Popen([sys.executable, NODE, mode, *ROBOTS], env=environment, stderr=subprocess.DEVNULL)
    try:
        scenario = folder / "six.toml"
        scenario.write_text(SCENARIO, encoding="utf-8")
        out = folder / "run.mcap"
        words = ("run", str(scenario), "--out", str(out), "--force", "--json", "--quiet", *words)
        return json.loads(protean(args, *words, "--set", f"processes.bridge.params.domain={domain}"))
    finally:
        node.terminate()
        try:
            node.wait(timeout=10)
        except subprocess.TimeoutExpired:
            # Fast DDS can lock itself at the end of a process.
            node.kill()
            node.wait()


def load():
    return f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("program", metavar="PROTEAN")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--runs", type=int, default=2)
    parser.add_argument("--hogs", type=int, default=3)
    parser.add_argument("--length", type=float, default=20.0, help="length of the runs in lock-step (s)")
    parser.add_argument("--rate", type=float, default=50.0, help="ticks per second of the run in real time")
    parser.add_argument("--seconds", type=float, default=60.0, help="length of the run in real time (s)")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        digests = collections.defaultdict(set)
        for hogs in (0, args.hogs):
            busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(hogs)]
            try:
                factors = []
                for seed in range(1, args.seeds + 1):
                    for _ in range(args.runs):
                        summary = run(args, folder, "timer", "--seed", str(seed), "--set", f"rules.time_limit={args.length}")
                        digests[seed].add(summary["digest"])
                        factors.append(summary["real_time_factor"])
                low, middle, high = min(factors), statistics.median(factors), max(factors)
                print(f"{hogs} hogs: {len(factors)} runs, {low:.1f} to {high:.1f} x real time, median {middle:.1f}; {load()}")
                several = [seed for seed, found in digests.items() if len(found) > 1]
                print(f"    seeds with more than one digest so far: {several or 'none'} of {len(digests)}", flush=True)
            finally:
                for process in busy:
                    process.kill()
                    process.wait()
        words = ("--real-time", "--set", f"run.dt={1 / args.rate}", "--set", f"rules.time_limit={args.seconds}")
        summary = run(args, folder, "event", *words)
        gaps = sum(topic["gaps"] for topic in summary["topics"].values())
        print(f"real time, {args.rate:g} Hz, {summary['ticks']} ticks: {gaps} messages lost in the run; {load()}")
        print(protean(args, "latency", str(folder / "run.mcap")))


if __name__ == "__main__":
    main()
