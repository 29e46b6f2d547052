"""Environments by name: ``gymnasium.make`` and ``make_vec``."""

import pickle
import re
import warnings
from pathlib import Path

import gymnasium
import numpy as np
import protean_robotics as pr
import pytest
from gymnasium.envs.registration import EnvSpec, registry
from gymnasium.utils.env_checker import check_env

NAMES = sorted(name for name in registry if name.startswith("protean/"))


def test_names_are_those_of_scenarios_with_goals_of_a_learner() -> None:
    assert {"protean/chase-v0", "protean/hello-v0", "protean/single_lane-v0"} <= {*NAMES}


@pytest.mark.parametrize("name", NAMES)
def test_a_made_env_passes_the_check_of_gymnasium(name: str) -> None:
    env = gymnasium.make(name, set={"rules.time_limit": 0.5})
    assert isinstance(env.unwrapped, pr.Env) and env.spec is not None and env.spec.id == name
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # It has no pictures.
        warnings.filterwarnings("ignore", message=".*render.*")
        check_env(env.unwrapped)


def test_the_specification_makes_the_same_again() -> None:
    env = gymnasium.make("protean/chase_exact-v0", agents=["police_1"], seed=3)
    assert env.spec is not None
    for spec in (pickle.loads(pickle.dumps(env.spec)), EnvSpec.from_json(env.spec.to_json())):
        again = gymnasium.make(spec)
        assert again.unwrapped.agents == ("police_1",)
        for _ in range(2):
            assert np.array_equal(again.reset()[0], env.reset()[0])
        env = gymnasium.make(env.spec)


def test_a_made_vector_is_one_of_ours() -> None:
    envs = gymnasium.make_vec("protean/hello-v0", num_envs=3, observation="state+path", seed=1)
    assert isinstance(envs, pr.VectorEnv) and envs.num_envs == 3
    assert envs.spec is not None and envs.spec.id == "protean/hello-v0"
    assert "path.proximity" in envs.entries[0]
    observations, _ = envs.reset()
    # Of single environments, which reset in another way.
    single = gymnasium.make_vec("protean/hello-v0", num_envs=3, vectorization_mode="sync", observation="state+path")
    assert single.reset(seed=[1, 2, 3])[0].shape == observations.shape


def test_the_code_of_the_documentation_about_names_and_options_runs() -> None:
    page = Path(__file__).parents[2] / "docs/how-to/environments.md"
    blocks = re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL)
    found = [block for block in blocks if "gymnasium.make" in block or "options=" in block]
    assert len(found) == 2
    for block in found:
        exec(compile(block, page.name, "exec"), {"pr": pr})
    names = re.search(r"The names are `protean/` \+ (.*?) \+ `-v0`", page.read_text(), re.DOTALL)
    assert names and sorted(f"protean/{name}-v0" for name in re.findall(r"`(\w+)`", names[1])) == NAMES


def test_texts_name_scenario_agents_and_instances() -> None:
    agents = ["evader_1"]
    assert repr(pr.VectorEnv("chase_exact", 2, agents=agents)) == (
        "VectorEnv('chase_exact', num_envs=2, agents=['evader_1'])"
    )
    assert repr(pr.Env("chase_exact", agents=agents)) == "Env('chase_exact', agents=['evader_1'])"
    assert repr(pr.parallel_env("chase_exact", agents=agents)) == "ParallelEnv('chase_exact', agents=['evader_1'])"
    made = gymnasium.make("protean/hello-v0")
    assert str(made) == "<OrderEnforcing<PassiveEnvChecker<Env('hello', agents=['robot'])>>>"
