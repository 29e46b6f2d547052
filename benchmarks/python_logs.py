#!/usr/bin/env python3
"""Time to read two topics of a log as arrays: `pr.Log` beside mcap-ros2-support.

usage: python_logs.py LOG

    pip install protean-robotics mcap-ros2-support      # or target/wheels/*.whl
    protean run chase --in-process --out chase.mcap
    benchmarks/python_logs.py chase.mcap

Ours reads all columns; the other reader the time and four fields of each element, as a user would write it.
"""

import argparse
import time
from pathlib import Path

import numpy as np
import protean_robotics as pr
from mcap_ros2.reader import read_ros2_messages

TOPICS = {"world/state": "robots", "perception/belief": "particles"}


def ours(path: Path) -> int:
    log = pr.Log(path)
    return sum(len(log[topic]["log_time_ns"]) for topic in TOPICS)


def other(path: Path) -> int:
    rows = 0
    for topic, elements in TOPICS.items():
        found = [
            (message.log_time_ns, element.x, element.y, element.theta)
            for message in read_ros2_messages(path, topics=[topic])
            for element in getattr(message.ros_msg, elements)
        ]
        rows += len(np.array(found))
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("log", type=Path)
    path = parser.parse_args().log
    times = {}
    for name, reader in (("pr.Log", ours), ("mcap-ros2-support", other)):
        begin = time.perf_counter()
        rows = reader(path)
        times[name] = time.perf_counter() - begin
        print(f"{name:18} {rows} rows in {times[name]:.2f} s")
    print(f"ratio {times['mcap-ros2-support'] / times['pr.Log']:.1f}")


if __name__ == "__main__":
    main()
