"""Texts of scenarios on imported worlds, and their check."""

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from ..._core import lab
from .files import InvalidMap, stem
from .world import World, number

#: Radius of a robot, in lengths of the world: a cell, or half the width of a street.
_RADIUS = 0.3
#: Distance between a Police robot and an evader at their starts, in lengths: none is captured at once.
_MIN_DISTANCE = 1.5
#: Number of seeds for which a scenario is checked.
_SEEDS = 4


class Imported(NamedTuple):
    """A file as scenario and map.

    Attributes
    ----------
    scenario
        Text of the scenario; it names the map.
    map_path
        Path of the map, relative to the scenario.
    map
        Text of the vector map.
    """

    scenario: str
    map_path: str
    map: str


def passing(path: Path, world: World, map_stem: str, texts: Iterable[str], last: str) -> Imported:
    """First of the scenarios on a world that passes the check with its seed, 1, and the next ones.

    Raises
    ------
    InvalidInput
        The problems of the last one, which `last` describes.
    """
    map_text = world.toml(map_stem)
    problems: list[str] = []
    for text in texts:
        # The map is not on disk yet.
        without = text.replace(f'map = "maps/{map_stem}.toml"\n', "")
        problems = lab.scenario_problems(f"{without}\n[world.map.vector]\n{map_text}", _SEEDS)
        if not problems:
            return Imported(text, f"maps/{map_stem}.toml", map_text)
    raise InvalidMap(
        f"{path}: no scenario passes the check on its {world.free_area():.2f} m² of free space, not even {last}: "
        + "; ".join(problems)
    )


def chase(path: Path, world: World, length: float) -> Imported:
    """Chase from random starts, whose sizes follow from a length of the world (m): four Police robots and two evaders, or
    fewer that are nearer to each other where space is short."""
    (left, bottom), (right, top) = world.corners()
    near = _MIN_DISTANCE * length
    far = max(min(10.0 * length, 0.25 * min(right - left, top - bottom)), near)
    sizes = [(4, 2, far), (4, 2, near), (2, 1, near), (1, 1, near)]
    map_stem = stem(path)
    texts = (_chase_text(map_stem, world, length, *size) for size in sizes)
    radius = _RADIUS * length
    last = f"one Police robot and one evader of radius {radius:.3f} m, {near:.3f} m apart"
    return passing(path, world, map_stem, texts, last)


def _chase_text(name: str, world: World, length: float, police: int, evaders: int, distance: float) -> str:
    speed, faster, near = number(length), number(1.1 * length), number(length)
    exits = ""
    place = world.place_in_corner(_RADIUS * length)
    if place is not None:
        x, y = map(number, place)
        exits = f"exits = [{{ circle = {{ center = [{x}, {y}], radius = {near} }} }}]  # [m]\n"
    apart = number(distance)
    return f"""\
# A chase on an imported map. `protean check --picture` draws it.

title = "Chase on {name}"
description = \"\"\"
Police that see along lines of sight chase evaders that run for the exit in the lower left corner, from random starts.\"\"\"

[run]
dt = 0.05  # [s]
seed = 1   # another seed is another layout

[world]
map = "maps/{name}.toml"
blur_sigma = {_blur(world)}  # [m]

[rules]
capture = {{ radius = {near} }}  # [m]
{exits}time_limit = 240.0  # [s]

{robot_text(length)}
[defaults.robot.random_start]
robot_distance = {near}  # [m]
opponent_distance = {apart}  # [m]
exit_distance = {apart}  # of an evader [m]

[teams.police]
count = {police}
limits = {{ v_max = {speed} }}  # [m/s]

[teams.evader]
count = {evaders}
limits = {{ v_max = {faster} }}  # [m/s]

[[robots]]
name = "police"
team = "police"

[[robots]]
name = "evader"
team = "evader"

[[processes]]
kind = "perception"

[[processes]]
kind = "pursuer"
team = "police"

[[processes]]
kind = "evader_potential"
team = "evader"
"""


def problems_text(name: str, map_stem: str, world: World, robot: str, robots: str) -> str:
    """Scenario of robots with starts and goals."""
    return f"""\
# Robots with starts and goals of an imported file of problems. `protean check --picture` draws it.

title = "Problems of {name}"
description = \"\"\"
Each robot drives from the start to the goal of a problem in minimum time; they keep apart.\"\"\"

[run]
dt = 0.05  # [s]
seed = 1

[world]
map = "maps/{map_stem}.toml"
blur_sigma = {_blur(world)}  # [m]

[rules]
time_limit = 600.0  # [s]

{robot}
{robots}[[processes]]
kind = "optimiser"

[[processes]]
kind = "navigator"
team = "neutral"
"""


def patrol_text(name: str, world: World, robots: int, radius: float, graph: str) -> str:
    """Scenario of robots of a radius (m) that patrol a graph, with the text of its table."""
    return f"""\
# A patrol of an imported graph. `protean check --picture` draws it.

title = "Patrol of {name}"
description = \"\"\"
Robots patrol the nodes of a graph by the strategy SEBS, from random starts.\"\"\"

[run]
dt = 0.05  # [s]
seed = 1

[world]
map = "maps/{name}.toml"
blur_sigma = {_blur(world)}  # [m]

[rules]
time_limit = 1800.0  # [s]

[[robots]]
name = "guard"
team = "neutral"
count = {robots}
random_start = {{}}
radius = {number(radius)}  # [m]
limits = {{ v_max = 1.0 }}  # [m/s]
scan = {{ beams = 72, angle_increment = 0.08726646259971647, range_min = 0.0, range_max = 2.0, noise = 0.0 }}

[[processes]]
name = "patrol"
kind = "patrol_graph"
team = "neutral"

[processes.params]
strategy = "state_exchange"

[processes.params.graph]
{graph}"""


def robot_text(length: float) -> str:
    """The table of all robots."""
    return (
        f"[defaults.robot]\nradius = {number(_RADIUS * length)}  # [m]\n"
        f"limits = {{ v_max = {number(length)} }}  # [m/s]\n"
    )


def _blur(world: World) -> str:
    """Standard deviation of the blur of the map (m): a cell, at most the largest one allowed."""
    return number(min(world.resolution, 10.0))
