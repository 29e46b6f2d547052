"""Limits of the program hold for arguments: what is beyond is refused, with the name, the length and the limit."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import protean_robotics as pr
import pytest

ROOM = pr.Map.from_grid(np.zeros((40, 40), dtype=bool), 0.1)
POINT, POSE = (1.0, 1.0), (1.0, 1.0, 0.0)
LIMITS = {"v_max": 1.0, "omega_max": 2.0}
EXITS, ROBOTS, BEAMS, CELLS, OBSTACLES = 1024, 64, 4096, 25_000_000, 4096
INSTANCES, TICKS, MISSIONS = 2**16, 10**8, 1_000_000
EXPERIMENT = 'scenario = "builtin:hello"\nseeds = { first = 1, count = 1 }\n'


def points(count: int) -> Any:
    return np.tile(POINT, (count, 1))


def poses(count: int) -> Any:
    return np.tile(POSE, (count, 1))


def circle(count: int) -> Any:
    angles = np.linspace(0, 6, count)
    return np.column_stack([3 * np.cos(angles), 3 * np.sin(angles)])


def advise(count: int) -> Any:
    ranges, angles = np.ones(count), np.linspace(0, 6, count)
    return pr.steering.TangentBug(0.1).advise(POSE, ranges, POINT, angles=angles, range_max=3.0)


def grid(count: int) -> pr.Map:
    return pr.Map.from_grid(np.broadcast_to(False, (5000, count // 5000 + (count % 5000 > 0))), 0.1)


def file(count: int) -> pr.Map:
    rows = count // 5000 + (count % 5000 > 0)
    text = f"resolution = 0.01\nbounds = {{ min = [0, 0], max = [50, {rows / 100}] }}\nmax_cells = 60_000_000\n"
    Path("map.toml").write_text(text)
    return pr.Map("map.toml")


def env(make: Any = pr.VectorEnv, **arguments: Any) -> Any:
    return make("hello", agents=["robot"], **arguments)


def discs(count: int) -> Any:
    obstacles = np.tile((4.0, 4.0, 0.1), (count, 1))
    return pr.trajectory.plan((0, 0, 0), (1, 0), discs=obstacles, bounds=[(-5, -5), (5, 5)], **LIMITS)


def sweep(**arguments: Any) -> Any:
    Path("experiment.toml").write_text(EXPERIMENT)
    return pr.sweep("experiment.toml", in_process=True, quiet=True, set={"rules.time_limit": 0.1}, **arguments)


def suggest(trial: Any) -> dict[str, Any]:
    return {}


#: Argument, its limit, and the call with so many.
CALLS: list[tuple[str, int, Callable[[int], Any]]] = [
    ("goals", EXITS, lambda n: pr.rrt_star.plan(ROOM, POINT, points(n), 0.1, iterations=1)),
    ("pursuers", ROBOTS, lambda n: pr.rrt_star.plan(ROOM, POINT, POINT, 0.1, iterations=1, pursuers=points(n))),
    ("iterations", 1_000_000, lambda n: n > 1_000_000 and pr.rrt_star.plan(ROOM, POINT, POINT, 0.1, iterations=n)),
    ("starts", EXITS, lambda n: pr.navigation.arrival_times(ROOM, points(n), 1.0, 0.1)),
    ("evaders", ROBOTS, lambda n: pr.navigation.dominance(ROOM, points(n), 1.0, [POINT], 1.0, radius=0.1)),
    ("pursuers", ROBOTS, lambda n: pr.navigation.dominance(ROOM, [POINT], 1.0, points(n), 1.0, radius=0.1)),
    ("count", 1000, lambda n: pr.navigation.shortest_paths(ROOM, POINT, (2.0, 1.0), 0.1, count=n)),
    ("goals", EXITS, lambda n: pr.steering.attraction(POINT, points(n))),
    ("robots", ROBOTS, lambda n: pr.steering.repulsion(POINT, points(n))),
    ("ranges", BEAMS, advise),
    ("observers", ROBOTS, lambda n: pr.tracking.visibility(ROOM, poses(n), POINT)),
    ("observers", ROBOTS, lambda n: pr.tracking.ParticleFilter(ROOM, **LIMITS).update(0.1, observers=poses(n))),
    (
        "particles",
        1_000_000,
        lambda n: pr.tracking.ParticleFilter(ROOM, **LIMITS, params={"particles": n}) if n > 1_000_000 else None,
    ),
    ("count", 1_000_000, lambda n: pr.coverage.Plan(ROOM, POINT, 0.1, margin=0.0).next(n)),
    ("obstacles", OBSTACLES, discs),
    ("blocked", CELLS, grid),
    ("source", CELLS, file),
    ("num_envs", INSTANCES, lambda n: env(num_envs=n)),
    ("threads", 1024, lambda n: env(threads=n)),
    ("ticks_per_action", TICKS, lambda n: env(ticks_per_action=n)),
    ("ticks_per_action", TICKS, lambda n: env(pr.Env, ticks_per_action=n)),
    ("seeds", MISSIONS, lambda n: n > MISSIONS and sweep(seeds=range(n))),
    ("seeds", MISSIONS, lambda n: pr.objective("hello", suggest, lambda run: 0.0, seeds=range(n))),
]


@pytest.mark.parametrize(("argument", "limit", "call"), CALLS)
def test_an_argument_has_the_limit_of_the_program(argument: str, limit: int, call: Callable[[int], Any]) -> None:
    call(limit)
    for beyond in (limit + 1, 2 * limit):
        with pytest.raises(pr.InvalidInput) as refused:
            call(beyond)
        text = str(refused.value)
        assert argument in text and any(spelling in text.replace(f"{beyond}", "") for spelling in spellings(limit)), text


def spellings(limit: int) -> list[str]:
    powers = [f"{base}^{exponent}" for base in (2, 10) for exponent in range(3, 32) if base**exponent == limit]
    return [str(limit), *powers, "1 million"] if limit == 1_000_000 else [str(limit), *powers]


def test_arrays_of_environments_have_a_limit_together() -> None:
    with pytest.raises(pr.InvalidInput, match="`num_envs` is 60000: expected fewer, with at most 2.26 numbers"):
        pr.VectorEnv("chase_exact", 60_000, agents=["evader", "police"], observation="state+scan", set=SCAN)


SCAN = {"defaults.robot.scan": {}}
