"""Every public function called with every kind of wrong argument: the exception is one of the package and names it."""

import inspect
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import protean_robotics as pr
import pytest

SHORT = {"rules.time_limit": 0.2}
EXPERIMENT = 'scenario = "builtin:hello"\nseeds = { first = 1, count = 2 }\n'


HOSTILE: list[Any] = [
    None,
    True,
    -1,
    3,
    2**70,
    1.5,
    float("nan"),
    "",
    "no such thing",
    "with\0zero",
    "\ud800",
    b"bytes",
    [],
    [1, 3],
    ["a", 1],
    {},
    {1: 2},
    {"a": None},
    {"a": object()},
    lambda: 0,
    lambda robot: (0.0, 0.0),
    object(),
    np.zeros(3),
    np.array(["a"]),
    print,
    int,
]


def steer(robot: pr.Robot) -> tuple[float, float]:
    return robot.v_max, 0.0


def sense(world: pr.World) -> list[tuple[float]]:
    return [(robot.x,) for robot in world.robots]


def suggest(trial: Any) -> dict[str, Any]:
    return SHORT


def value(run: pr.Run) -> float:
    return run.time


def env_of(make: Any, **more: Any) -> Any:
    return make("hello", agents=["robot"], set=SHORT, seed=1, **more)


def started(make: Any) -> Any:
    env = env_of(make)
    env.reset()
    return env


def log(values: dict[str, Any] = SHORT) -> pr.Log:
    pr.run("hello", in_process=True, set=values, out="log.mcap", force=True)
    return pr.Log("log.mcap")


def objective(**arguments: Any) -> Any:
    none = lambda *given: None
    trial = SimpleNamespace(set_user_attr=none, report=none, should_prune=none)
    return pr.objective(**arguments)(trial)


ENV = {
    "scenario": "hello",
    "agents": ["robot"],
    "observation": "state",
    "action": "twist",
    "seed": 1,
    "set": SHORT,
    "reward": None,
    "planners": None,
    "ticks_per_action": 1,
    "record": True,
    "render_mode": None,
    "allow_outside": False,
}
RUN = {
    "scenario": "hello",
    "seed": 1,
    "set": SHORT,
    "in_process": True,
    "planners": {"robot": steer},
    "processes": {},
    "out": "out.mcap",
    "force": True,
    "allow_external": False,
    "allow_outside": False,
}
SWEEP = {
    "experiment": "experiment.toml",
    "out": None,
    "executor": None,
    "shards": None,
    "jobs": None,
    "seeds": range(1, 3),
    "set": SHORT,
    "in_process": True,
    "planners": {"robot": steer},
    "retry_failed": False,
    "keep_logs": "none",
    "worst": "contacts=max",
    "allow_external": False,
    "allow_outside": False,
    "quiet": True,
}
EPISODE = {"path": "episode.mcap", "running": True, "force": True}
MAP = pr.Map("hello")
POSE, POINT = (1.0, 1.0, 0.0), (1.0, 1.0)
LIMITS = {"v_max": 1.0, "omega_max": 2.0}

#: Function and its valid arguments; each is replaced in turn.
CALLS: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "run": (pr.run, RUN),
    "sweep": (pr.sweep, SWEEP),
    "objective": (
        objective,
        {"scenario": "hello", "suggest": suggest, "value": value, "seeds": [1], "set": {}, "planners": None}
        | {"allow_outside": False},
    ),
    "planner": (pr.planner, {"steer": steer}),
    "serve": (lambda steer: pr.serve(steer), {"steer": steer}),
    "process": (
        lambda **arguments: pr.process(**arguments)(sense),
        {"reads": ["sonar/echo"], "writes": {"sonar/echo": [("range", "f8")]}},
    ),
    "Env": (pr.Env, ENV),
    "VectorEnv": (
        pr.VectorEnv,
        ENV | {"num_envs": 2, "threads": 1, "copy": True, "autoreset_mode": "NextStep"},
    ),
    "parallel_env": (pr.parallel_env, ENV),
    "Env.reset": (lambda **a: env_of(pr.Env).reset(**a), {"seed": 1, "options": None}),
    "VectorEnv.reset": (lambda **a: env_of(pr.VectorEnv).reset(**a), {"seed": 1, "options": None}),
    "ParallelEnv.reset": (lambda **a: env_of(pr.parallel_env).reset(**a), {"seed": 1, "options": None}),
    "Env.step": (lambda **a: started(pr.Env).step(**a), {"action": np.zeros(2)}),
    "VectorEnv.step": (lambda **a: started(pr.VectorEnv).step(**a), {"actions": np.zeros((1, 2))}),
    "ParallelEnv.step": (lambda **a: started(pr.parallel_env).step(**a), {"actions": {"robot": [0, 0]}}),
    "ParallelEnv.step of one": (lambda robot: started(pr.parallel_env).step({"robot": robot}), {"robot": [0, 0]}),
    "ParallelEnv.action_space": (lambda **a: env_of(pr.parallel_env).action_space(**a), {"agent": "robot"}),
    "ParallelEnv.observation_space": (lambda **a: env_of(pr.parallel_env).observation_space(**a), {"agent": "robot"}),
    "VectorEnv.episode": (lambda **a: started(pr.VectorEnv).episode(**a), {"i": 0, "running": True}),
    "VectorEnv.digest": (lambda **a: started(pr.VectorEnv).digest(**a), {"i": 0, "running": True}),
    "VectorEnv.save_log": (lambda **a: started(pr.VectorEnv).save_log(**a), {"i": 0} | EPISODE),
    "Env.save_log": (lambda **a: started(pr.Env).save_log(**a), EPISODE),
    "ParallelEnv.save_log": (lambda **a: started(pr.parallel_env).save_log(**a), EPISODE),
    "reward": (
        lambda returned: _step_of(reward=lambda step: returned),
        {"returned": np.zeros(1)},
    ),
    "reward weight": (lambda weight: _step_of(reward={"time": weight}), {"weight": 1.0}),
    "Log": (pr.Log, {"path": "log.mcap"}),
    "Log.report": (lambda **a: pr.Log("log.mcap").report(**a), {"out": "a.html", "force": True}),
    "Log.picture": (lambda **a: pr.Log("log.mcap").picture(**a), {"out": "a.svg", "at": 0.1, "force": True}),
    "Log.branch": (
        lambda **a: pr.Log("log.mcap").branch(**a),
        {"at": 0.1, "set": {}, "draw": {}, "replace": {}, "command": {"robot": (0.1, 0.0)}, "place": {}, "duration": 0.1, "reseed": ["all"], "seed": 2}
        | {"out": "branch.mcap", "force": True, "allow_external": False},
    ),
    "Log.decided": (
        lambda **a: pr.Log("log.mcap").decided(**a),
        {"moments": 1, "continuations": 1, "share": 0.9, "set": {}, "draw": {}, "replace": {}, "command": {}, "place": {}, "duration": None, "reseed": None}
        | {"allow_external": False},
    ),
    "Steering": (pr.Steering, {"v": 1.0, "omega": 1.0, "target": 1, "aim": POINT, "waypoint": POINT}),
    "Map": (pr.Map, {"source": "hello"}),
    "Map.from_grid": (
        pr.Map.from_grid,
        {"blocked": np.zeros((40, 40), bool), "resolution": 0.1, "origin": POINT, "blur_sigma": 0.2},
    ),
    "Map.path": (MAP.path, {"start": POINT, "goal": (2.0, 1.0), "radius": 0.1}),
    "Map.path_length": (MAP.path_length, {"start": POINT, "goal": (2.0, 1.0), "radius": 0.1}),
    "Map.clearance": (MAP.clearance, {"points": POINT}),
    "Map.line_is_clear": (MAP.line_is_clear, {"start": POINT, "ends": POINT, "radius": 0.1}),
    "Map.free_run": (MAP.free_run, {"start": POINT, "ends": POINT, "radius": 0.1}),
    "Map.cast_rays": (MAP.cast_rays, {"at": POINT, "angles": [0.0], "range_max": 1.0}),
    "Map.away_from_obstacles": (MAP.away_from_obstacles, {"points": POINT}),
    "Map.visible": (MAP.visible, {"at": POINT, "range": 1.0, "field_of_view": 1.0, "heading": 0.0}),
    "navigation.arrival_times": (
        pr.navigation.arrival_times,
        {"map": MAP, "starts": [POINT], "speeds": [1.0], "radius": 0.1, "pitch": None},
    ),
    "navigation.dominance": (
        pr.navigation.dominance,
        {"map": MAP, "evaders": [POINT], "evader_speeds": [1.0], "pursuers": [(2.0, 1.0)], "pursuer_speeds": [1.0]}
        | {"radius": 0.1, "capture_radius": 0.1, "pitch": None},
    ),
    "navigation.shortest_paths": (
        pr.navigation.shortest_paths,
        {"map": MAP, "start": POINT, "goal": (2.0, 1.0), "radius": 0.1, "count": 2, "max_length": None},
    ),
    "coverage.Plan": (
        pr.coverage.Plan,
        {"map": MAP, "start": POINT, "radius": 0.1, "seed": 1, "sub_goals": 20, "loops": 1, "margin": 0.0}
        | {"tolerance": 0.1},
    ),
    "patrol.ZigZag": (
        pr.patrol.ZigZag,
        {"contour": [(0, 0), (4, 0), (4, 4), (0, 4)], "t_max": 1.0, "alpha": 0.5, "seed": 1},
    ),
    "patrol.detection": (
        lambda **arguments: pr.patrol.detection(log({"rules.time_limit": 2}), **arguments),
        {"duration": 0.1, "distance": 1.0, "places": [POINT], "robots": ["robot"], "start": 0.0},
    ),
    "rrt_star.plan": (
        pr.rrt_star.plan,
        {"map": MAP, "start": POINT, "goals": [(2.0, 1.0)], "radius": 0.1, "iterations": 5, "seed": 1}
        | {"pursuers": None, "pursuer_speed": 1.0, "v_max": 1.0, "omega_max": 1.0, "params": None},
    ),
    "steering.PathTracker": (pr.steering.PathTracker, {"path": [POINT, (2.0, 1.0)], "params": None}),
    "steering.TangentBug": (pr.steering.TangentBug, {"radius": 0.1}),
    "steering.attraction": (pr.steering.attraction, {"points": POINT, "goals": [POINT], "weights": None}),
    "steering.go_to": (
        pr.steering.go_to,
        {"pose": POSE, "target": POINT, "dt": 0.1, "v_reverse_max": 0.0, "params": None} | LIMITS,
    ),
    "steering.linearise": (
        pr.steering.linearise,
        {"velocity": POINT, "heading": 0.0, "v_reverse_max": 0.0, "params": None} | LIMITS,
    ),
    "steering.repulsion": (
        pr.steering.repulsion,
        {"points": POINT, "robots": [POINT], "weights": None, "params": None},
    ),
    "tracking.ParticleFilter": (
        pr.tracking.ParticleFilter,
        {"map": MAP, "start": POSE, "v_reverse_max": 0.0, "seed": 1, "params": None} | LIMITS,
    ),
    "tracking.visibility": (
        pr.tracking.visibility,
        {"map": MAP, "observers": [POSE], "points": [POINT], "sensor": None},
    ),
    "trajectory.plan": (
        pr.trajectory.plan,
        {"start": POSE, "goal": (2.0, 1.0), "discs": None, "polygons": None, "bounds": [(0, 0), (5, 5)]}
        | {"v_min": None, "clearance": 0.0, "start_speed": None, "start_turn_rate": None, "goal_speed": None}
        | {"acceleration": None, "angular_acceleration": None, "wheels": None}
        | LIMITS,
    ),
}


def _step_of(**arguments: Any) -> None:
    env = env_of(pr.VectorEnv, **arguments)
    env.reset()
    env.step(np.zeros((1, 2)))


def allowed(error: Exception, argument: str) -> bool:
    """An exception of the package; of compiled functions also Python's own for an object of another class, by its name."""
    if isinstance(error, pr.Error):
        return True
    return type(error) is TypeError and f"while processing '{argument}'" in getattr(error, "__notes__", [])


@pytest.mark.parametrize("name", CALLS)
def test_wrong_arguments_are_named(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("PROTEAN_CONFIG", raising=False)
    Path("experiment.toml").write_text(EXPERIMENT)
    log()
    call, valid = CALLS[name]
    for argument in valid:
        for hostile in HOSTILE:
            if argument in ("suggest", "value") and callable(hostile):
                # What it raises is its own.
                continue
            try:
                call(**valid | {argument: hostile})
            except SystemExit as error:
                # A planner that no run has started.
                assert name == "serve" and error.code == 2
            except Exception as error:
                assert allowed(error, argument), f"{argument} = {hostile!r}: {type(error).__name__}: {error}"


def test_every_public_function_is_tried() -> None:
    #: They take no arguments, or the package calls them.
    without = {"program", "go_to", "Belief", "Episode", "Error", "Executor", "Future", "InvalidInput", "Planner"}
    without |= {"Message", "Output", "Process"}
    without |= {"MissingFile", "ParallelEnv", "Robot", "Run", "Scan", "Step", "Sweep", "Table", "Topic", "World"}
    public = {name for name in pr.__all__ if callable(getattr(pr, name))}
    assert public - without <= CALLS.keys()
    for name, (call, valid) in CALLS.items():
        if call in (pr.run, pr.sweep, pr.parallel_env, pr.VectorEnv, pr.Env):
            assert inspect.signature(call).parameters.keys() == valid.keys(), name


def test_what_is_natural_is_accepted() -> None:
    Path("experiment.toml").write_text(EXPERIMENT)
    lists: list[Any] = [range(1, 4), [1, 2, 3], (1, 2, 3), np.arange(1, 4)]
    for i, seeds in enumerate(lists):
        done = pr.sweep("experiment.toml", out=f"{i}", seeds=seeds, set=SHORT, in_process=True, quiet=True)
        assert done.summary["missions"] == 3
    # A function without the decorator.
    decorated = pr.run("hello", in_process=True, set=SHORT, planners={"robot": pr.planner(steer)})
    assert pr.run("hello", in_process=True, set=SHORT, planners={"robot": steer}).digest == decorated.digest
    assert pr.run("hello", in_process=True, set=SHORT, seed=np.int64(3)).seed == 3
    with pytest.raises(ValueError, match="seed = -1: expected a whole number from 0"):
        pr.run("hello", seed=-1)
    with pytest.raises(pr.InvalidInput, match="consecutive whole numbers"):
        pr.sweep("experiment.toml", seeds=[1, 3])
    with pytest.raises(pr.InvalidInput, match="reward = 3: expected weights by their names"):
        pr.VectorEnv("hello", agents=["robot"], reward=3)  # type: ignore[arg-type]
    with pytest.raises(pr.InvalidInput, match="executor = 3: expected an object with submit"):
        pr.sweep("experiment.toml", executor=3)  # type: ignore[arg-type]
    with pytest.raises(pr.InvalidInput, match="set = \\['a=1'\\]: expected a mapping"):
        pr.run("hello", set=["a=1"])  # type: ignore[arg-type]


class Junk:
    """An executor that returns something else."""

    def __init__(self, returned: Any) -> None:
        self.returned = returned

    def submit(self, call: Any, /, *arguments: Any) -> Any:
        return self.returned


@pytest.mark.parametrize(
    "returned",
    [None, 3, *(SimpleNamespace(done=lambda: True, result=lambda part=part: part) for part in (None, 3, b"", b"PK"))],
)
def test_what_an_executor_returns_may_be_junk(returned: Any) -> None:
    Path("experiment.toml").write_text(EXPERIMENT)
    with pytest.raises(pr.Error, match="parts failed"):
        pr.sweep("experiment.toml", executor=Junk(returned), shards=1, set=SHORT, in_process=True, quiet=True)
