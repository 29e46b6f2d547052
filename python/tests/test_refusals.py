"""What is refused: the exceptions are those of Python, and speak of arguments, not of options of the command."""

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import protean_robotics as pr
import pytest

SHORT = {"rules.time_limit": 0.2}
EXPERIMENT = 'scenario = "builtin:hello"\nseeds = { first = 1, count = 1 }\n[[cases]]\nname = "a"\nset.rules.time_limit = 0.2\n'
#: It starts a program.
EXTERNAL = """
rules.time_limit = 0.2
[world.map.vector]
bounds = { min = [0, 0], max = [4, 4] }
[[robots]]
name = "robot"
team = "neutral"
start = { x = 1, y = 1, theta = 0 }
[[processes]]
name = "planner"
command = ["true"]
robots = ["robot"]
"""


def steer(robot: pr.Robot) -> tuple[float, float]:
    return robot.v_max, 0.0


def run(scenario: str = "hello", **arguments: Any) -> pr.Run:
    return pr.run(scenario, **{"in_process": True, "set": SHORT} | arguments)


def sweep(experiment: str = "experiment.toml", **arguments: Any) -> pr.Sweep:
    return pr.sweep(experiment, **{"in_process": True, "quiet": True} | arguments)


def log() -> pr.Log:
    return run(out="log.mcap", force=True).log


def env(**arguments: Any) -> Any:
    return pr.Env("hello", **{"agents": ["robot"], "set": SHORT, "seed": 1} | arguments)


def vector(**arguments: Any) -> Any:
    return pr.VectorEnv("hello", **{"agents": ["robot"], "set": SHORT, "seed": 1} | arguments)


def parallel(**arguments: Any) -> Any:
    made = pr.parallel_env("hello", **{"agents": ["robot"], "set": SHORT, "seed": 1} | arguments)
    made.reset()
    return made


def written(name: str, text: str) -> str:
    Path(name).write_text(text)
    return name


def with_other_results() -> pr.Sweep:
    sweep()
    return sweep(written("other/experiment.toml", EXPERIMENT.replace("0.2", "0.3")), out="results/experiment")


def save_twice(made: Any, *instance: int) -> None:
    made.reset(seed=1)
    made.save_log(*instance, "kept", running=True)


#: Calls whose text names an option in the command, and the argument that it names here.
OPTIONS: dict[str, tuple[Callable[[], Any], str]] = {
    "existing log": (lambda: run(out="kept"), "force=True"),
    "existing log of processes": (lambda: run(out="kept", in_process=False), "force=True"),
    "existing page": (lambda: log().report("kept.html"), "force=True"),
    "existing picture": (lambda: log().picture("kept.svg"), "force=True"),
    "time of a picture": (lambda: log().picture("a.svg", at=1e9), "`at`"),
    "existing episode": (lambda: save_twice(env()), "force=True"),
    "existing episode of a vector": (lambda: save_twice(vector(num_envs=1), 0), "force=True"),
    "existing episode of agents": (lambda: save_twice(parallel()), "force=True"),
    "value": (lambda: run(set={"rules.time_limit": -1}), "`set`"),
    "value with processes": (lambda: run(set={"rules.time_limit": -1}, in_process=False), "`set`"),
    "value of an environment": (lambda: env(set={"rules.time_limit": -1}), "`set`"),
    "value of a sweep": (lambda: sweep(set={"rules.time_limit": -1}), "`set`"),
    "value of a sweep with planners": (
        lambda: sweep(set={"rules.time_limit": -1}, planners={"robot": steer}),
        "`set`",
    ),
    "value of a parameter": (lambda: sweep("parameter.toml", set=SHORT), "`set`"),
    "key of a parameter": (lambda: sweep("key.toml"), "`set`"),
    "program": (lambda: run("external.toml", in_process=False, set=None), "allow_external=True"),
    "program of a sweep": (lambda: sweep("external-sweep.toml", in_process=False), "allow_external=True"),
    "program of a sweep in one thread": (
        lambda: sweep("external-sweep.toml", allow_external=True),
        "in_process=True",
    ),
    "results of another sweep": (with_other_results, "`out`"),
    "directory with something else": (lambda: sweep(out="full"), "`out`"),
    "failure": (lambda: run("chase", set={"processes.perception.on_failure": "restart"}), "run.mode"),
}


@pytest.mark.parametrize("name", OPTIONS)
def test_texts_speak_of_arguments(name: str) -> None:
    for kept in ("kept", "kept.html", "kept.svg", "full/results.csv"):
        Path(kept).parent.mkdir(exist_ok=True)
        Path(kept).touch()
    Path("other").mkdir()
    written("experiment.toml", EXPERIMENT)
    written("external.toml", EXTERNAL)
    written("external-sweep.toml", 'scenario = "external.toml"\nseeds = { first = 1, count = 1 }\n')
    parameter = '[parameters.limit]\nset = {}\n[grid]\nlimit = [0.2, 0.3]\n'
    plain = EXPERIMENT.split("[[cases]]")[0]
    written("parameter.toml", plain + parameter.format('"rules.time_limit"'))
    written("key.toml", plain + parameter.format("3"))
    call, argument = OPTIONS[name]
    with pytest.raises(pr.Error) as raised:
        call()
    text = str(raised.value)
    assert argument in text and not re.search(r"(?<![\w-])--[a-z]", text), text


#: Calls that are refused, with what the text names.
REFUSED: dict[str, tuple[Callable[[], Any], type[Exception], str]] = {
    "planner of a run": (lambda: run(planners={"robot": 3}), pr.InvalidInput, "planner = 3"),
    "planner of a sweep": (lambda: sweep(planners={"robot": 3}), pr.InvalidInput, "planner = 3"),
    "planner of an environment": (lambda: vector(planners={"robot": 3}), pr.InvalidInput, "planner = 3"),
    "planner of a program": (lambda: pr.serve(3), pr.InvalidInput, "planner = 3"),  # type: ignore[arg-type]
    "None": (lambda: run(set={"rules.time_limit": None}), pr.InvalidInput, "set: rules.time_limit = None"),
    "None in an environment": (lambda: env(set={"title": None}), pr.InvalidInput, "set: title = None"),
    "list": (lambda: run(set=["a=1"]), pr.InvalidInput, "set = "),
    "executor": (lambda: sweep(executor=3), pr.InvalidInput, "executor = 3"),
    "no actions": (lambda: parallel().step({}), pr.InvalidInput, "actions: none of robot"),
    "seed below 0": (lambda: run(seed=-1), pr.InvalidInput, "seed = -1"),
    "seed too large": (lambda: run(seed=2**64), pr.InvalidInput, "seed = 18446744073709551616"),
    "seed of an environment": (lambda: env(seed=-1), pr.InvalidInput, "seed = -1"),
    "seed of a reset": (lambda: env().reset(seed=2**64), pr.InvalidInput, "seed = 18446744073709551616"),
    "seeds of a sweep": (lambda: sweep(seeds=[-1]), pr.InvalidInput, "seeds = -1"),
    "seed of an algorithm": (
        lambda: pr.rrt_star.plan(pr.Map("hello"), (1.0, 1.0), [(2.0, 1.0)], 0.1, seed=-1),
        pr.InvalidInput,
        "whole number from 0",
    ),
    "negative number": (lambda: vector(num_envs=-1), pr.InvalidInput, "num_envs = -1"),
    "unknown keyword": (lambda: pr.run("hello", sed=1), TypeError, "sed"),  # type: ignore[call-arg]
    "unknown keyword of an environment": (lambda: env(rewards=1), TypeError, "rewards"),
    "unknown option": (lambda: env().reset(options={"curriculum": 1}), pr.InvalidInput, "curriculum"),
    "log of a run without one": (lambda: run().log, pr.InvalidInput, "no log: expected out=PATH"),
    "missing scenario": (lambda: run("no.toml"), FileNotFoundError, "no.toml"),
    "missing scenario of processes": (lambda: run("no.toml", in_process=False), FileNotFoundError, "no.toml"),
    "missing scenario of an environment": (
        lambda: pr.Env("no.toml", agents=["robot"]),
        FileNotFoundError,
        "no.toml",
    ),
    "missing experiment": (lambda: sweep("no.toml"), FileNotFoundError, "no.toml"),
    "missing experiment with planners": (
        lambda: sweep("no.toml", planners={"robot": steer}),
        FileNotFoundError,
        "no.toml",
    ),
    "missing log": (lambda: pr.Log("no.mcap"), FileNotFoundError, "no.mcap"),
    "missing map": (lambda: pr.Map("no.toml"), FileNotFoundError, "no.toml"),
    "missing image of a map": (lambda: pr.Map("no.yaml"), FileNotFoundError, "no.yaml"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused_is_named(name: str) -> None:
    written("experiment.toml", EXPERIMENT)
    call, kind, text = REFUSED[name]
    with pytest.raises(kind, match=re.escape(text)) as raised:
        call()
    if kind is not TypeError:
        assert isinstance(raised.value, pr.InvalidInput) and isinstance(raised.value, ValueError)


def test_a_function_without_the_decorator_is_a_planner_everywhere() -> None:
    written("experiment.toml", EXPERIMENT)
    planners: dict[str, Any] = {"robot": steer}
    decorated = run(planners={"robot": pr.planner(steer)})
    assert run(planners=planners).digest == decorated.digest
    assert sweep(planners=planners).summary["missions"] == 1
    score = pr.objective("hello", lambda trial: SHORT, lambda run: run.time, seeds=[1], planners=planners)
    assert score(type("Trial", (), dict.fromkeys(("set_user_attr", "report", "should_prune"), lambda *_: None))()) == pytest.approx(0.2)
    for make in (pr.Env, pr.VectorEnv, pr.parallel_env):
        chase: Any = make("chase_exact", agents=["evader_1"], planners={"police": steer}, set=SHORT, seed=1)
        chase.reset()
    actions = np.zeros((1, 2))
    envs: Any = pr.VectorEnv("chase_exact", agents=["evader_1"], planners={"police": steer}, set=SHORT, seed=1)
    envs.reset()
    envs.step(actions)


def test_the_module_is_the_program() -> None:
    module = [sys.executable, "-m", "protean_robotics", "--version"]
    done = subprocess.run(module, capture_output=True, text=True, check=False)
    assert done.stdout == subprocess.run([pr.program(), "--version"], capture_output=True, text=True, check=True).stdout


def test_environments_are_public_names() -> None:
    assert {"Env", "ParallelEnv", "VectorEnv", "parallel_env"} <= {*pr.__all__}
