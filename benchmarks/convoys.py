#!/usr/bin/env python3
"""Missions in which robots must pass each other in lanes and doors that are too narrow for two.

usage: convoys.py [--kind lane|door] [--count N] [--seed N] [--robots MIN MAX] [--depth M] [--protean PROGRAM] [--keep DIR]

    cargo build -p protean
    benchmarks/convoys.py --kind lane --count 100

A lane is 0.4 m wide and has at least one bay of 0.7 m x 0.6 m for two robots of the smaller of two convoys, which swap its ends;
`--depth` is another depth of the bays. Doors of 0.34 m connect two rooms; each robot drives to a random place in the other room. A robot that has not arrived at the time limit is stuck.
Standard library only.
"""

import argparse
import json
import math
import random
import subprocess
import tempfile
from pathlib import Path

WIDTH = 0.4
BAY = 0.7
DOOR = 0.34
ROOM = (2.0, 2.4)


def rectangle(x0: float, y0: float, x1: float, y1: float) -> str:
    center, half = [(x0 + x1) / 2, (y0 + y1) / 2], [(x1 - x0) / 2, (y1 - y0) / 2]
    return f"[[world.map.vector.obstacles]]\nshape.rectangle = {{ center = {center}, half_extents = {half} }}\n"


def robot(name: str, start: tuple[float, float], theta: float, goal: tuple[float, float]) -> str:
    return (
        f'[[robots]]\nname = "{name}"\nteam = "neutral"\n'
        f"start = {{ x = {start[0]}, y = {start[1]}, theta = {theta} }}\n"
        f"goal = {{ circle = {{ center = {list(goal)}, radius = 0.05 }} }}\n"
    )


def mission(size: tuple[float, float], obstacles: list[str], robots: list[str], limit: float) -> str:
    names = [f"r{i}" for i in range(len(robots))]
    return (
        f"[world.map.vector]\nbounds = {{ min = [0.0, 0.0], max = {list(size)} }}\n{''.join(obstacles)}"
        f"[rules]\ntime_limit = {limit}\n{''.join(robots)}"
        f'[[processes]]\nkind = "optimiser"\n[[processes]]\nkind = "navigator"\nrobots = {json.dumps(names)}\n'
    )


def lane(draw: random.Random, count: int, depth: float) -> str:
    east = draw.randint(1, count - 1)
    convoys = [east, count - east]
    gap = draw.uniform(0.32, 0.45)
    bays = math.ceil(min(convoys) / 2) + draw.randint(0, 2)
    pitch = BAY + 0.2
    free = draw.uniform(0.2, 1.5)
    # No bay is beside the ends: one beside a robot that has arrived is of no use.
    end = 0.2 + gap * max(convoys)
    length = bays * pitch + free + 2 * end
    low, high = depth, depth + WIDTH
    shares = sorted(draw.uniform(0.0, free) for _ in range(bays))
    lefts = [end + share + i * pitch for i, share in enumerate(shares)]
    obstacles = []
    sides = [draw.random() < 0.5 for _ in lefts]
    for is_up in (True, False):
        y0, y1 = (high, high + depth) if is_up else (0.0, low)
        x = 0.0
        for left, side in zip(lefts, sides, strict=True):
            if side == is_up:
                obstacles.append(rectangle(x, y0, left, y1))
                x = left + BAY
        obstacles.append(rectangle(x, y0, length, y1))
    y = low + WIDTH / 2
    places = [
        [(0.2 + gap * i, y) for i in range(max(convoys))],
        [(length - 0.2 - gap * i, y) for i in range(max(convoys))],
    ]
    robots = []
    for side, size in enumerate(convoys):
        for i in range(size):
            # The first robot of a convoy drives to the end of the lane.
            start, goal = places[side][size - 1 - i], places[1 - side][i]
            robots.append((start, [0.0, math.pi][side], goal))
    draw.shuffle(robots)
    listed = [robot(f"r{i}", *r) for i, r in enumerate(robots)]
    return mission((length, high + depth), obstacles, listed, 150.0 + 30.0 * count)


def door(draw: random.Random, count: int, _depth: float) -> str:
    size = (2 * ROOM[0] + 0.1, ROOM[1])
    at = draw.uniform(0.3, ROOM[1] - 0.3)
    wall = [
        rectangle(ROOM[0], 0.0, ROOM[0] + 0.1, at - DOOR / 2),
        rectangle(ROOM[0], at + DOOR / 2, ROOM[0] + 0.1, ROOM[1]),
    ]

    def place(side: int, others: list[tuple[float, float]]) -> tuple[float, float]:
        while True:
            x = draw.uniform(0.2, ROOM[0] - 0.2) + side * (ROOM[0] + 0.1)
            p = (x, draw.uniform(0.2, ROOM[1] - 0.2))
            if all(math.dist(p, q) > 0.4 for q in others) and math.dist(p, (ROOM[0] + 0.05, at)) > 0.5:
                return p

    starts: list[tuple[float, float]] = []
    goals: list[tuple[float, float]] = []
    robots = []
    for i in range(count):
        side = draw.randint(0, 1)
        starts.append(place(side, starts))
        goals.append(place(1 - side, goals))
        robots.append(robot(f"r{i}", starts[-1], draw.uniform(-3.0, 3.0), goals[-1]))
    return mission(size, wall, robots, 150.0 + 30.0 * count)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kind", choices=["lane", "door"], default="lane")
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--robots", type=int, nargs=2, default=[3, 8])
    parser.add_argument("--depth", type=float, default=0.6, help="depth of the bays (m)")
    parser.add_argument("--protean", default="target/debug/protean")
    parser.add_argument("--keep", type=Path, help="directory for the missions")
    args = parser.parse_args()
    scratch = None if args.keep else tempfile.TemporaryDirectory()
    folder = args.keep or Path(scratch.name)
    folder.mkdir(parents=True, exist_ok=True)
    stuck_missions = stuck_robots = all_robots = all_contacts = 0
    durations = []
    for i in range(args.count):
        draw = random.Random(f"{args.kind} {args.seed} {i}")
        count = draw.randint(*args.robots)
        file = folder / f"{args.kind}_{args.seed}_{i}.toml"
        file.write_text({"lane": lane, "door": door}[args.kind](draw, count, args.depth))
        call = [args.protean, "run", str(file), "--in-process", "--quiet", "--json"]
        done = subprocess.run(call, capture_output=True, text=True)
        if done.returncode:
            raise SystemExit(f"{file}: {done.stderr}")
        summary = json.loads(done.stdout)
        robots = summary["robots"]
        stuck = sum(robot["outcome"] != "goal_reached" for robot in robots)
        contacts = sum(robot["contacts"] for robot in robots)
        stuck_missions += stuck > 0
        stuck_robots += stuck
        all_robots += count
        all_contacts += contacts
        last = max(robot.get("time_s") or math.inf for robot in robots)
        durations += [] if stuck else [last]
        print(f"{file.stem}: {count} robots, {stuck} stuck, {contacts} contacts, {last:.2f} s", flush=True)
    middle = sorted(durations)[len(durations) // 2] if durations else math.nan
    print(
        f"{args.kind}, seed {args.seed}: {stuck_missions} of {args.count} missions and {stuck_robots} of {all_robots} robots stuck, "
        f"{all_contacts} contacts; median duration {middle:.2f} s, maximum {max(durations, default=math.nan):.2f} s"
    )


if __name__ == "__main__":
    main()
