"""Public objects in other processes: they are pickled, or refused in words."""

import copy
import importlib
import inspect
import multiprocessing
import pickle
import sys
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from types import ModuleType
from typing import Any

import gymnasium
import numpy as np
import protean_robotics as pr
import pytest

SHORT = {"rules.time_limit": 0.2}
ROOM = np.zeros((40, 40), dtype=bool)
ROOM[10:, 20] = True
LIMITS = {"v_max": 0.5, "omega_max": 2.0}


@pr.planner
def steer(robot: pr.Robot) -> tuple[float, float]:
    return robot.v_max, 0.0


@pr.process(writes={"sonar/echo": [("range", "f8")]})
def sense(world: pr.World) -> list[tuple[float]]:
    return [(robot.x,) for robot in world.robots]


def suggest(trial: Any) -> dict[str, Any]:
    return SHORT


def value(run: pr.Run) -> float:
    return run.time


def room() -> pr.Map:
    return pr.Map.from_grid(ROOM, 0.1, (1.0, 2.0), blur_sigma=0.3)


def run() -> pr.Run:
    done = pr.run("hello", in_process=True, set=SHORT, out="log.mcap", force=True)
    assert done.log
    return done


def experiment() -> pr.Sweep:
    Path("experiment.toml").write_text('scenario = "builtin:hello"\nseeds = { first = 1, count = 1 }\n')
    return pr.sweep("experiment.toml", set=SHORT, in_process=True, quiet=True)


def first(env: Any) -> Any:
    """What an environment has to show."""
    env.reset()
    return env.digest(*(() if not isinstance(env, pr.VectorEnv) else (0,)), running=True)


def grids(map: pr.Map) -> Any:
    return map.bounds, map.grid, map.clearance_grid, pr.steering.obstacle_push(map, (1.5, 2.5))


def seen() -> pr.Step:
    steps: list[pr.Step] = []

    def reward(step: pr.Step) -> Any:
        steps.append(step)
        return np.zeros(1)

    env = pr.VectorEnv("hello", agents=["robot"], reward=reward, set=SHORT, seed=1)
    env.reset()
    env.step(np.zeros((1, 2)))
    return steps[0]


def episode() -> pr.Episode:
    env = pr.Env("hello", agents=["robot"], set=SHORT, seed=1)
    env.reset()
    return env.episode(running=True)


def tree() -> pr.rrt_star.Tree:
    return pr.rrt_star.plan(room(), (1.5, 2.5), (4.5, 2.5), 0.1, iterations=200)


def trajectory() -> pr.trajectory.Trajectory:
    return pr.trajectory.plan((0, 0, 0), (3, 0), discs=[(1.5, 1, 0.3)], bounds=[(-5, -5), (5, 5)], **LIMITS)


def fields(names: list[str]) -> Callable[[Any], Any]:
    return lambda given: [getattr(given, name) for name in names]


TREE = ["path", "reached", "cost", "nodes", "parents", "costs"]
TRAJECTORY = ["time", "pose", "v", "omega", "duration", "lower_bound", "length", "status", "obstacles"]

#: How to make an object, and what its copy has in common with it.
PICKLED: dict[str, list[tuple[Callable[[], Any], Callable[[Any], Any]]]] = {
    "Env": [(lambda: pr.Env("hello", agents=["robot"], set=SHORT, seed=1, planners={}), first)],
    "Episode": [(episode, lambda given: (given.seed, given.actions))],
    "Error": [(lambda: pr.Error("reason"), lambda given: given.args)],
    "InvalidInput": [(lambda: pr.InvalidInput("reason"), lambda given: given.args)],
    "Log": [(lambda: run().log, lambda given: (given.info, given["world/state"]["robots.x"]))],
    "Message": [(lambda: pr.Message(1, np.zeros(2)), lambda given: (given.header, given.elements))],
    "MissingFile": [(lambda: pr.MissingFile("reason"), lambda given: given.args)],
    "Map": [(room, grids), (lambda: pr.Map("hello"), grids), (lambda: pr.Map(MAP), grids)],
    "ParallelEnv": [(lambda: pr.parallel_env("hello", agents=["robot"], set=SHORT, seed=1), first)],
    "Output": [(lambda: pr.Output([("range", "f8")], most=3), lambda given: (given.most, np.dtype(given.dtype).itemsize))],
    "Planner": [(lambda: steer, lambda given: given.steer)],
    "Process": [(lambda: sense, lambda given: given.steer)],
    "Run": [(run, lambda given: (given.summary, given.log.digest))],
    "Steering": [
        (lambda: pr.Steering(1.0, 0.5, target=1, aim=(1, 2)), fields(["v", "omega", "target", "aim", "waypoint"]))
    ],
    "Step": [(seen, fields(["before", "observations", "actions", "events", "rewards", "terminated", "dt"]))],
    "Sweep": [(experiment, lambda given: (given.directory, given.summary))],
    "Table": [(lambda: run().log.robots, lambda given: given.to_numpy())],
    "Topic": [(lambda: run().log["world/state"], lambda given: (given.messages, given.to_numpy()))],
    "VectorEnv": [(lambda: pr.VectorEnv("chase_exact", 2, agents=["evader_1"], threads=2, seed=1), first)],
    "executors.HyperQueue": [(lambda: pr.executors.HyperQueue("client", "folder"), lambda given: given._folder)],
    "executors.Ray": [(pr.executors.Ray, lambda given: type(given))],
    "rrt_star.Tree": [(tree, fields(TREE))],
    "trajectory.Trajectory": [(trajectory, fields(TRAJECTORY))],
}
MAP = "map.toml"

#: Reasons of the refusals.
TICK = "values are those of a tick of a run"
STATE = "it has a state"
REFUSED: dict[str, tuple[Callable[[], Any], str]] = {
    "Belief": (lambda: inputs()["belief"], TICK),
    "Robot": (lambda: inputs()["robot"], TICK),
    "Scan": (lambda: inputs()["scan"], TICK),
    "World": (lambda: inputs()["world"], TICK),
    "coverage.Plan": (lambda: pr.coverage.Plan(room(), (1.5, 2.5), 0.1, margin=0.0), STATE),
    "patrol.ZigZag": (lambda: pr.patrol.ZigZag([(0, 0), (4, 0), (4, 4)], t_max=1.0, alpha=0.5), STATE),
    "steering.PathTracker": (lambda: pr.steering.PathTracker([(0, 0), (1, 0)]), STATE),
    "steering.TangentBug": (lambda: pr.steering.TangentBug(0.1), STATE),
    "tracking.ParticleFilter": (lambda: pr.tracking.ParticleFilter(room(), **LIMITS), STATE),
}
#: Protocols: objects of other packages.
PROTOCOLS = {"Executor", "Future"}


def inputs() -> dict[str, Any]:
    """Inputs of a planner in a tick."""
    found: dict[str, Any] = {}

    def look(robot: Any, world: Any, scan: Any, belief: Any, map: Any) -> tuple[float, float]:
        if scan is not None and belief:
            found.update(robot=robot, world=world, scan=scan, belief=next(iter(belief.values())), map=map)
        return 0.0, 0.0

    values = {"rules.time_limit": 1, "defaults.robot.scan": {"beams": 8}}
    pr.run("chase", in_process=True, planners={"police_1": look}, set=values)
    return found


@pytest.fixture(autouse=True)
def _map() -> None:
    bounds = {"min": [0, 0], "max": [3, 2]}
    text = "".join(f"bounds.{name} = {corner}\n" for name, corner in bounds.items())
    Path(MAP).write_text(f"resolution = 0.1\n{text}obstacles = []\n")


def public() -> dict[str, Any]:
    """Public classes and functions by name."""
    found: dict[str, Any] = {}
    for name in [*pr.__all__, *pr._GYM]:
        item = getattr(pr, name)
        if isinstance(item, ModuleType):
            found |= {f"{name}.{own}": getattr(item, own) for own in item.__all__}
        elif callable(item):
            found[name] = item
    return found


def test_every_public_class_is_pickled_or_has_a_reason() -> None:
    classes = {name for name, item in public().items() if inspect.isclass(item)}
    assert classes == {*PICKLED, *REFUSED, *PROTOCOLS}


def test_classes_and_functions_travel_by_name() -> None:
    for name, item in public().items():
        assert pickle.loads(pickle.dumps(item)) is item, name


def assert_same(one: Any, other: Any, name: str) -> None:
    if isinstance(one, dict):
        assert one.keys() == other.keys(), name
        one, other = list(one.values()), list(other.values())
    if isinstance(one, (list, tuple)) and not isinstance(one, str):
        assert len(one) == len(other), name
        for mine, yours in zip(one, other, strict=True):
            assert_same(mine, yours, name)
    else:
        np.testing.assert_array_equal(one, other, err_msg=name)


@pytest.mark.parametrize("name", PICKLED)
def test_a_copy_is_as_the_object(name: str) -> None:
    for make, seen in PICKLED[name]:
        made = make()
        assert type(made).__name__ == name.split(".")[-1]
        before = seen(made)
        for copied in (pickle.loads(pickle.dumps(made)), copy.deepcopy(made)):
            assert type(copied) is type(made)
            assert_same(before, seen(copied), name)


@pytest.mark.parametrize("name", REFUSED)
def test_a_refusal_says_why(name: str) -> None:
    make, reason = REFUSED[name]
    made = make()
    assert type(made).__name__ == name.split(".")[-1]
    for copied in (pickle.dumps, copy.deepcopy):
        with pytest.raises(TypeError, match=f"cannot pickle a {type(made).__name__}: .*{reason}"):
            copied(made)


def test_what_cannot_be_made_again_is_refused() -> None:
    with pytest.raises(TypeError, match="cannot pickle a Map: it is the map of a run"):
        pickle.dumps(inputs()["map"])

    class Own(pr.Env):
        pass

    with pytest.raises(TypeError, match="cannot pickle a Own: expected __reduce__ in the class"):
        pickle.dumps(Own("hello", agents=["robot"]))


def test_an_objective_travels() -> None:
    objective = pr.objective("hello", suggest, value, seeds=[1, 2], planners={"robot": steer})
    assert pickle.loads(pickle.dumps(objective)) == objective


#: What a process of a pool does with objects of its parent.
WORK = """
import numpy as np
import protean_robotics as pr

def steer(robot):
    return robot.v_max, 0.0

def work(map, env):
    env.reset()
    env.step(np.zeros(2, dtype=np.float32))
    done = pr.run("hello", in_process=True, seed=1, set={"rules.time_limit": 0.2}, planners={"robot": steer})
    way = map.path((1.5, 2.5), (4.5, 2.5), 0.1)
    return [map.clearance((1.5, 2.5)), way.tolist(), env.digest(running=True), done.digest]
"""


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_processes_of_every_start_method_use_the_package(
    method: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    Path("work_of_the_pool.py").write_text(WORK)
    monkeypatch.syspath_prepend(tmp_path)
    sys.modules.pop("work_of_the_pool", None)
    work = importlib.import_module("work_of_the_pool").work
    map, env = room(), pr.Env("chase_exact", agents=["evader_1"], seed=1)
    here = work(map, env)
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context(method)) as pool:
        assert [future.result() for future in [pool.submit(work, map, env)] * 2] == [here, here]
        # A function of the compiled part, by itself.
        assert pool.submit(pr.steering.attraction, (0, 0), [(3, 0)]).result().tolist() == [2.0, 0.0]


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_asynchronous_vectors_of_every_start_method_play_the_same_episodes(method: str) -> None:
    def first(envs: Any) -> Any:
        observations, _ = envs.reset(seed=[5, 7])
        stepped, *_ = envs.step(np.ones((2, 2), dtype=np.float32))
        envs.close()
        return np.stack([observations, stepped])

    makes = [lambda: pr.Env("chase_exact", agents=["evader_1"])] * 2
    here = first(gymnasium.vector.SyncVectorEnv(makes))
    assert np.array_equal(here, first(gymnasium.vector.AsyncVectorEnv(makes, context=method)))
