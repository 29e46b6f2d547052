#!/usr/bin/env python3
"""Draws planning instances; the same count and seed give the same file.

    python3 benchmarks/make_instances.py base --count 30 --seed 1 benchmarks/instances/base_small.json

The recipes, and the command for every file in `benchmarks/instances`: see
`benchmarks/collocation_baseline/README.md`. Only numpy is needed.
"""

import argparse
import json
import math
import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from collocation_baseline import guess, instance  # noqa: E402

CM_PER_PX = 0.75
WIDTH, HEIGHT = 640.0, 480.0
CLEAR_PX = 2.0


class Draw:
    """Numbers from one seed. Of `random`, only `random()` guarantees the same numbers in all versions."""

    def __init__(self, seed):
        self.source = random.Random(seed)

    def uniform(self, low, high, digits=3):
        return round(low + (high - low) * self.source.random(), digits)

    def integer(self, low, high):
        return low + int(self.source.random() * (high - low + 1))


def clear(place, discs, buffer_px):
    return all(
        math.dist(place, (disc["x"], disc["y"])) >= disc["r"] + buffer_px + CLEAR_PX for disc in discs
    )


def draw_discs(draw, count, smallest, largest):
    return [
        {
            "x": draw.uniform(0.0, WIDTH),
            "y": draw.uniform(0.0, HEIGHT),
            "r": draw.uniform(smallest, largest),
        }
        for _ in range(count)
    ]


def across(draw, discs, radii, heading):
    """From one corner of the board to the other; speed and turn rate may step."""
    start = {"x": draw.uniform(0.0, 20.0), "y": draw.uniform(0.0, 20.0)}
    start["theta"] = round(math.radians(draw.uniform(*heading, 6)), 6)
    goal = {"x": draw.uniform(WIDTH - 20.0, WIDTH), "y": draw.uniform(HEIGHT - 20.0, HEIGHT)}
    return {
        "cm_per_px": CM_PER_PX,
        "vmax_px_s": 20.0,
        "v_min": 0.0,
        "wmax_rad_s": 16.0,
        "buffer_px": 10.0,
        "bounds_px": [0.0, 0.0, WIDTH, HEIGHT],
        "start": start,
        "start_speed": None,
        "goal": goal,
        "obstacles": draw_discs(draw, draw.integer(*discs), *radii),
    }


def inertia(draw, index, discs, limits):
    """A robot with wheels 0.16 m apart and limited accelerations, moving or with a given last heading half of the time."""
    metres = 100.0 / CM_PER_PX
    v_max = round(0.22 * metres, 6)
    turn_rate, acceleration, angular_acceleration = limits
    margin = 10.0
    place = lambda: {"x": draw.uniform(margin, WIDTH - margin), "y": draw.uniform(margin, HEIGHT - margin)}
    start, goal = place(), place()
    towards = math.atan2(goal["y"] - start["y"], goal["x"] - start["x"])
    start["theta"] = round(towards + draw.uniform(-1.5, 1.5, 6), 6)
    final = round(towards + draw.uniform(-math.pi / 2, math.pi / 2, 6), 6)
    speed = draw.uniform(0.3 * v_max, 0.8 * v_max)
    moving, heading_given = index % 2 == 1, index // 2 % 2 == 1
    if heading_given:
        goal["theta"] = final
    return {
        "cm_per_px": CM_PER_PX,
        "vmax_px_s": v_max,
        "v_min": 0.0,
        "wmax_rad_s": turn_rate,
        "buffer_px": 14.0,
        "bounds_px": [0.0, 0.0, WIDTH, HEIGHT],
        "wheel_speed_px_s": v_max,
        "wheel_separation_px": round(0.16 * metres, 6),
        "acceleration_px_s2": acceleration,
        "angular_acceleration_rad_s2": angular_acceleration,
        "start": start,
        "start_speed": speed if moving else 0.0,
        "start_turn_rate": 0.0,
        "goal": goal,
        "goal_speed": 0.0,
        "obstacles": draw_discs(draw, draw.integer(*discs), 10.0, 30.0),
    }


def slow_turning(draw, index, reverse):
    """A turning radius of 10 to 100 px; any heading, a given last one half of the time, every fifth goal near."""
    margin = 10.0
    place = lambda: {"x": draw.uniform(margin, WIDTH - margin), "y": draw.uniform(margin, HEIGHT - margin)}
    start, goal = place(), place()
    start["theta"] = draw.uniform(-math.pi, math.pi, 6)
    final = draw.uniform(-math.pi, math.pi, 6)
    away, direction = draw.uniform(20.0, 100.0), draw.uniform(-math.pi, math.pi, 6)
    if index % 5 == 4:
        goal["x"] = round(start["x"] + away * math.cos(direction), 3)
        goal["y"] = round(start["y"] + away * math.sin(direction), 3)
    if index % 2 == 1:
        goal["theta"] = final
    return {
        "cm_per_px": CM_PER_PX,
        "vmax_px_s": 20.0,
        "v_min": -20.0 if reverse else 0.0,
        "wmax_rad_s": round(0.2 * 10.0 ** draw.uniform(0.0, 1.0, 6), 4),
        "buffer_px": 10.0,
        "bounds_px": [0.0, 0.0, WIDTH, HEIGHT],
        "start": start,
        "start_speed": None,
        "goal": goal,
        "obstacles": draw_discs(draw, draw.integer(0, 16), 12.0, 30.0),
    }


def standing(draw, limits):
    """The robot of `inertia` at rest, on a board without discs; the caller places both."""
    return inertia(draw, 0, (0, 0), limits)


def braking(draw, index):
    """A moving robot, and a disc ahead of it, little farther than it needs to stop; every other one between two discs."""
    raw = standing(draw, BURGER if index % 2 == 0 else HEAVY)
    speed = round(draw.uniform(0.6, 0.95) * raw["vmax_px_s"], 3)
    stop = speed**2 / (2.0 * raw["acceleration_px_s2"])
    radius = draw.uniform(20.0, 50.0)
    gap = stop * draw.uniform(1.05, 2.0) + 1.0
    centre = 120.0 + gap + raw["buffer_px"] + CLEAR_PX + radius
    discs = [{"x": round(centre, 3), "y": round(240.0 + draw.uniform(-0.1, 0.1) * radius, 3), "r": radius}]
    beside = draw.uniform(28.0, 40.0)
    if index % 4 >= 2:
        discs += [{"x": 125.0, "y": 240.0 + side * beside, "r": 12.0} for side in (1.0, -1.0)]
    goal = {"x": 560.0, "y": draw.uniform(60.0, 420.0)}
    final = draw.uniform(-math.pi / 2, math.pi / 2, 6)
    if index % 3 == 0:
        goal["theta"] = final
    start = {"x": 120.0, "y": 240.0, "theta": 0.0}
    return raw | {"start": start, "start_speed": speed, "goal": goal, "obstacles": discs}


def parking(draw, index):
    """A near goal with a heading between three discs, for a robot that turns slowly and may drive backwards."""
    raw = slow_turning(draw, 0, reverse=True)
    heading = draw.uniform(-math.pi, math.pi, 6)
    goal = {"x": 320.0, "y": 240.0, "theta": heading}
    away, direction = draw.uniform(40.0, 150.0), draw.uniform(-math.pi, math.pi, 6)
    start = {
        "x": round(320.0 + away * math.cos(direction), 3),
        "y": round(240.0 + away * math.sin(direction), 3),
        "theta": draw.uniform(-math.pi, math.pi, 6),
    }
    radius = draw.uniform(6.0, 14.0)
    discs = []
    for turn in (0.5 * math.pi, -0.5 * math.pi, math.pi if index % 2 == 0 else 0.0):
        angle, apart = heading + turn, radius + raw["buffer_px"] + draw.uniform(3.0, 10.0)
        x, y = 320.0 + apart * math.cos(angle), 240.0 + apart * math.sin(angle)
        discs.append({"x": round(x, 3), "y": round(y, 3), "r": radius})
    return raw | {"start": start, "goal": goal, "obstacles": discs}


def serpentine(draw, index):
    """Three walls of discs, each with a gap at another place."""
    raw = (
        standing(draw, BURGER if index % 4 == 1 else HEAVY)
        if index % 2 == 1
        else slow_turning(draw, 0, reverse=False)
    )
    discs = []
    for wall in range(3):
        x, low = 160.0 + 160.0 * wall, draw.uniform(40.0, 380.0)
        high = low + 2.0 * (raw["buffer_px"] + draw.uniform(2.0, 20.0))
        for side, edge in ((-1.0, low), (1.0, high)):
            y = edge + side * 12.0
            while -20.0 <= y <= HEIGHT + 20.0:
                discs.append({"x": x, "y": round(y, 3), "r": 12.0})
                y += side * 33.0
    start = {"x": 45.0, "y": draw.uniform(60.0, 420.0), "theta": draw.uniform(-math.pi, math.pi, 6)}
    goal = {"x": 595.0, "y": draw.uniform(60.0, 420.0)}
    return raw | {"start": start, "goal": goal, "obstacles": discs}


def tie(draw, index):
    """A board that is its own mirror image, with the robot on its axis."""
    raw = standing(draw, BURGER if index % 2 == 0 else HEAVY)
    discs = []
    for column in range(5):
        x, radius, apart = 168.0 + 76.0 * column, draw.uniform(10.0, 40.0), draw.uniform(0.0, 70.0)
        if apart < radius:
            discs.append({"x": x, "y": 240.0, "r": radius})
        else:
            discs += [{"x": x, "y": 240.0 + side * apart, "r": radius} for side in (-1.0, 1.0)]
    goal = {"x": 600.0, "y": 240.0}
    if index % 3 > 0:
        goal["theta"] = 0.0 if index % 3 == 1 else round(math.pi, 6)
    start = {"x": 40.0, "y": 240.0, "theta": 0.0 if index % 4 < 2 else round(math.pi, 6)}
    return raw | {"start": start, "goal": goal, "obstacles": discs}


def thin(draw, index):
    """A board that is hardly wider than the robot's way past discs at its edges."""
    raw = (
        standing(draw, BURGER) if index % 2 == 0 else slow_turning(draw, 0, reverse=index % 4 == 3)
    )
    height = draw.uniform(30.0, 80.0)
    discs = [
        {
            "x": draw.uniform(80.0, 560.0),
            "y": round((-0.5 if draw.uniform(0.0, 1.0) < 0.5 else 0.5) * height + 240.0, 3),
            "r": draw.uniform(5.0, 0.6 * height),
        }
        for _ in range(draw.integer(2, 6))
    ]
    place = lambda x: {"x": x, "y": round(240.0 + draw.uniform(-0.3, 0.3) * height, 3)}
    start, goal = place(30.0), place(610.0)
    start["theta"] = draw.uniform(-math.pi, math.pi, 6)
    raw["bounds_px"] = [0.0, round(240.0 - 0.5 * height, 3), WIDTH, round(240.0 + 0.5 * height, 3)]
    return raw | {"start": start, "goal": goal, "obstacles": discs}


BURGER = (2.84, round(0.5 * 100.0 / CM_PER_PX, 6), 3.0)
HEAVY = (1.2, 12.0, 0.6)
RECIPES = {
    "base": lambda draw, _: across(draw, (10, 20), (5.0, 15.0), (40.0, 45.0)),
    "obs30_40": lambda draw, _: across(draw, (30, 40), (5.0, 15.0), (40.0, 45.0)),
    "dense": lambda draw, _: across(draw, (30, 40), (20.0, 30.0), (0.0, 90.0)),
    "dynamics": lambda draw, index: inertia(draw, index, (5, 15), BURGER),
    "heavy": lambda draw, index: inertia(draw, index, (5, 15), HEAVY),
    "crowded": lambda draw, index: inertia(draw, index, (18, 28), BURGER),
    "slow_turning": lambda draw, index: slow_turning(draw, index, reverse=False),
    "slow_turning_reverse": lambda draw, index: slow_turning(draw, index, reverse=True),
    "braking": braking,
    "parking": parking,
    "serpentine": serpentine,
    "ties": tie,
    "thin": thin,
}


def acceptable(raw):
    """Ends clear and apart, room to brake straight ahead, and a path on a grid."""
    start, goal = raw["start"], raw["goal"]
    ends = [(start["x"], start["y"]), (goal["x"], goal["y"])]
    if math.dist(*ends) < (19.9 if raw["row"].startswith(("slow", "parking")) else 250.0):
        return False
    left, low, right, high = raw["bounds_px"]
    on_board = lambda x, y: left <= x <= right and low <= y <= high
    if not all(on_board(x, y) for x, y in ends):
        return False
    brake = 0.0
    if raw["start_speed"]:
        brake = raw["start_speed"] ** 2 / (2.0 * raw["acceleration_px_s2"]) + (0.5 if raw["row"] == "braking" else 5.0)
    for step in range(9):
        ahead = brake * step / 8.0
        x = start["x"] + ahead * math.cos(start["theta"])
        y = start["y"] + ahead * math.sin(start["theta"])
        if not on_board(x, y):
            return False
        if not clear((x, y), raw["obstacles"], raw["buffer_px"]):
            return False
    if not clear(ends[1], raw["obstacles"], raw["buffer_px"]):
        return False
    return guess.grid_path(instance.parse(raw)) is not None


def make(kind, count, seed):
    draw = Draw(seed)
    drawn = []
    while len(drawn) < count:
        name = {"id": f"{kind}-{seed}-{len(drawn):04d}", "row": kind, "seed": seed}
        raw = name | RECIPES[kind](draw, len(drawn))
        if acceptable(raw):
            drawn.append(raw)
    return drawn


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("kind", choices=RECIPES)
    parser.add_argument("out", metavar="OUT.json")
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    drawn = make(args.kind, args.count, args.seed)
    with open(args.out, "w", encoding="utf-8") as file:
        file.write("[\n" + ",\n".join(json.dumps(each) for each in drawn) + "\n]\n")


if __name__ == "__main__":
    main()
