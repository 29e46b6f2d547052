"""``python -m protean_robotics.lab worlds``: the chasing game in random offices and forests, and the verdicts on tactics.

``worlds make office DIR`` writes an experiment, ``DIR/office.toml``, whose layouts differ in the map and in the starts:
`protean sweep` plays every tactic of the Police on each. ``worlds judge RESULTS…`` compares the tactics game by game.
"""

import argparse
import itertools
import json
import random
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from .._errors import InvalidInput
from . import files
from .results import Results, read
from .statistics import Difference, Sample, holm

#: Half the side of the free square within the outer wall (m), as in the city.
_HALF = 8.0
#: Half the thickness of walls between rooms (m).
_WALL = 0.1
#: Half the width of doors (m).
_DOOR = 0.5
#: Rooms along each side of an office.
_ROOMS = 4
#: Discs of a forest.
_DISCS = 60
#: Least space between two discs, and between a disc and the wall (m).
_SPACE = 0.5
#: Half the side of the square in which a robot starts (m); its corners are further than the least distance of starts.
_START = 2.5
#: Whose squares a layout sets. That of ``police_4`` is the team's, which the control overrides.
_STARTS = (
    "robots.police_1",
    "robots.police_2",
    "robots.police_3",
    "teams.police",
    "robots.evader_1",
    "robots.evader_2",
)

#: A shape of a map, as its file has it.
Shape = dict[str, Any]
#: Makes the shapes within the outer wall.
Maker = Callable[[random.Random], list[Shape]]


def _rectangle(left: float, low: float, right: float, high: float) -> Shape:
    center, half = ([(left + right) / 2.0, (low + high) / 2.0], [(right - left) / 2.0, (high - low) / 2.0])
    return {"rectangle": {"center": [round(v, 3) for v in center], "half_extents": [round(v, 3) for v in half]}}


def _outer() -> list[Shape]:
    """The outer wall of the city, 1 m thick, with its gap of 2.5 m on the right."""
    end = _HALF + 1.0
    sides = [(-end, -end, -_HALF, end), (-end, -end, end, -_HALF), (-end, _HALF, end, end)]
    return [_rectangle(*s) for s in [*sides, (_HALF, -end, end, -1.25), (_HALF, 1.25, end, end)]]


def office(draw: random.Random) -> list[Shape]:
    """Four by four rooms; doors 1 m wide make a random tree of them, and are in half of the other walls."""
    pitch = 2.0 * _HALF / _ROOMS
    inner = [[i * pitch - _HALF + draw.uniform(-0.8, 0.8) for i in range(1, _ROOMS)] for _ in range(2)]
    lines = [[-_HALF, *axis, _HALF] for axis in inner]
    # A wall is named by its axis, 0 for one that is crossed along x, and the room before it.
    walls = [
        (axis, room)
        for axis in range(2)
        for room in itertools.product(range(_ROOMS), repeat=2)
        if room[axis] + 1 < _ROOMS
    ]
    draw.shuffle(walls)
    parts = {room: room for room in itertools.product(range(_ROOMS), repeat=2)}
    shapes = []
    for axis, room in walls:
        beyond = (room[0] + 1, room[1]) if axis == 0 else (room[0], room[1] + 1)
        ours, theirs = parts[room], parts[beyond]
        parts = {other: ours if part == theirs else part for other, part in parts.items()}
        at, along = lines[axis][room[axis] + 1], lines[1 - axis]
        start, end = along[room[1 - axis]], along[room[1 - axis] + 1]
        door = draw.uniform(start + _WALL + _DOOR + 0.2, end - _WALL - _DOOR - 0.2)
        is_open = draw.random() < 0.5 or ours != theirs
        pieces = [(start, door - _DOOR), (door + _DOOR, end)] if is_open else [(start, end)]
        for a, b in pieces:
            across, length = ((at - _WALL, at + _WALL), (a - _WALL if a == start else a, b + _WALL if b == end else b))
            x, y = (across, length) if axis == 0 else (length, across)
            shapes.append(_rectangle(x[0], y[0], x[1], y[1]))
    return shapes


def forest(draw: random.Random) -> list[Shape]:
    """60 discs with radii of 0.2 to 0.5 m, at least 0.5 m from each other and from the wall."""
    discs: list[tuple[float, float, float]] = []
    while len(discs) < _DISCS:
        radius = draw.uniform(0.2, 0.5)
        reach = _HALF - _SPACE - radius
        x, y = draw.uniform(-reach, reach), draw.uniform(-reach, reach)
        if all((x - a) ** 2 + (y - b) ** 2 >= (radius + r + _SPACE) ** 2 for a, b, r in discs):
            discs.append((x, y, radius))
    return [{"circle": {"center": [round(x, 3), round(y, 3)], "radius": round(r, 3)}} for x, y, r in discs]


_WORLDS: dict[str, Maker] = {"forest": forest, "office": office}


def _map(world: str, draw: random.Random) -> str:
    shapes = _outer() + _WORLDS[world](draw)
    exits = [{"rectangle": {"center": [9.0, 0.0], "half_extents": [0.5, 1.25]}}]
    head = f"name = {json.dumps(world)}\nbounds = {{ min = [-9.5, -9.5], max = [9.5, 9.5] }}\nresolution = 0.05\n"
    body = "".join(f"\n[[obstacles]]\nshape = {_inline(shape)}\n" for shape in shapes)
    return f"{head}exits = [{', '.join(map(_inline, exits))}]\n{body}"


def _inline(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_inline(item)}" for key, item in value.items()) + " }"
    return json.dumps(value)


_HEAD = """\
# Written by `python -m protean_robotics.lab worlds make WORLD`.

title = "Tactics of the Police: WORLD"
scenario = "builtin:chase"
seeds = { first = 1, count = 1 }

[[cases]]
name = "nearest"
title = "follow the nearest"
[cases.set]
processes.evader_potential.params.threat.gain = 3.0
processes.pursuer.params = { knowledge = "exact", assignment = { method = "nearest_sticky", knowledge = "exact" } }

[[cases]]
name = "standing"
title = "one stands in the gap, the others follow"
[cases.set]
processes.evader_potential.params.threat.gain = 3.0
processes.pursuer.params = { knowledge = "exact", assignment = { method = "nearest_sticky", knowledge = "exact" } }
robots.police_4.limits.v_max = 0.001
robots.police_4.random_start.region.rectangle = { center = [8.35, 0.0], half_extents = [0.01, 0.01] }

[[cases]]
name = "cut_off"
title = "cut off"
[cases.set]
processes.evader_potential.params.threat.gain = 3.0
processes.pursuer.params = { knowledge = "exact", assignment = { method = "cut_off", knowledge = "exact" } }

[parameters.relative_speed]
title = "evader speed / Police speed"
set = "teams.evader.limits.v_max"
scale = "teams.police.limits.v_max"
"""


def experiment(world: str, layouts: int, first: int, speeds: Sequence[float]) -> tuple[str, dict[str, str]]:
    """Text of the experiment, and of its maps by the names of their files.

    Layouts are numbered from ``first``, which names their random numbers: each has a map, and for each robot a square,
    5 m wide and anywhere inside the wall, in which it starts.
    """
    maps: dict[str, str] = {}
    levels = []
    for number in range(first, first + layouts):
        draw = random.Random(f"{world} {number}")
        name = f"maps/{world}_{number}.toml"
        maps[name] = _map(world, draw)
        reach = _HALF - _START
        places = [[round(draw.uniform(-reach, reach), 3) for _ in range(2)] for _ in _STARTS]
        robots = "".join(
            f"{robot}.random_start.region.rectangle = {{ center = {place}, half_extents = [{_START}, {_START}] }}\n"
            for robot, place in zip(_STARTS, places, strict=True)
        )
        levels.append(f"\n[parameters.layout.levels.l{number}]\nworld.map = {json.dumps(name)}\n{robots}")
    names = json.dumps([f"l{number}" for number in range(first, first + layouts)])
    grid = f"\n[grid]\nrelative_speed = {json.dumps(list(speeds))}\nlayout = {names}\n"
    return _HEAD.replace("WORLD", world) + "".join(levels) + grid, maps


def judge(studies: Sequence[Results]) -> str:
    """Shares of escapes with intervals by game, and the differences of every two tactics on the same layouts.

    The differences have McNemar's exact test by game, by Holm's method over all of them.
    """
    lines: list[str] = []
    pairs: list[tuple[str, Difference]] = []
    for results in studies:
        if "layout" not in results.parameters:
            raise InvalidInput(f"{results.directory}: no parameter layout: expected the results of `worlds make`")
        layout = results.parameters.index("layout")
        games: dict[tuple[Any, ...], dict[str, dict[int, tuple[int, int]]]] = {}
        for index, cell in enumerate(results.cells):
            number = int(cell.values[layout][1:])
            rest = (*cell.values[:layout], *cell.values[layout + 1 :])
            played = games.setdefault(rest, {}).setdefault(cell.case, {})
            for seed, row in results.finished(index).items():
                played[number * 2**32 + seed] = (row["escaped"], row["evaders"])
        lines.append(f"{results.title}: {len(results.rows)} games, {results.failed} failed")
        for values, cases in games.items():
            name = " ".join([results.name, *map(str, values)])
            for case, played in cases.items():
                sample = Sample.of(played.values())
                if sample.share is not None:
                    low, high = (100.0 * end for end in sample.interval())
                    share = f"{100.0 * sample.share:.0f} % ({low:.0f} … {high:.0f})"
                    lines.append(f"{name} {case}: {share}, {sample.hits} of {sample.members}")
            for (one, first), (other, second) in itertools.combinations(cases.items(), 2):
                if difference := Difference.of(first, second):
                    pairs.append((f"{name} {one} − {other}", difference))
    adjusted = holm([difference.p_value for _, difference in pairs])
    for (name, difference), p_value in zip(pairs, adjusted, strict=True):
        low, high = (100.0 * end for end in difference.interval())
        more, fewer = difference.larger
        points = f"{100.0 * difference.value:+.0f} points ({low:+.0f} … {high:+.0f})"
        lines.append(f"{name}: {points}, more in {more} games, fewer in {fewer}, p = {p_value:.2g}")
    return "\n".join(lines)


def main(arguments: Sequence[str]) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m protean_robotics.lab worlds", description=(__doc__ or "").partition("\n")[0]
    )
    commands = parser.add_subparsers(dest="command", required=True)
    make = commands.add_parser("make", help="write an experiment and its maps")
    make.add_argument("world", choices=sorted(_WORLDS))
    make.add_argument("directory", type=Path)
    make.add_argument("--layouts", type=int, default=200, help="number of layouts (default: %(default)s)")
    make.add_argument("--first", type=int, default=1, help="number of the first layout (default: %(default)s)")
    make.add_argument(
        "--speeds", type=float, nargs="+", default=[1.5], help="evader speed / Police speed (default: 1.5)"
    )
    compare = commands.add_parser("judge", help="compare the tactics")
    compare.add_argument("results", type=Path, nargs="+", help="directories of results")
    options = parser.parse_args(arguments)
    try:
        if options.command == "make":
            if options.layouts < 1:
                raise InvalidInput(f"--layouts is {options.layouts}: expected 1 or more")
            text, maps = experiment(options.world, options.layouts, options.first, options.speeds)
            for name, content in {**maps, f"{options.world}.toml": text}.items():
                files.save(options.directory / name, content.encode())
        else:
            print(judge([read(directory) for directory in options.results]))
    except (InvalidInput, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0
