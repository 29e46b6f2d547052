"""``pr.sb3.VecEnv`` against stable-baselines3's own vector of ``pr.Env``; without the library (it needs torch, a very large
download) only the refusal is tested. ``examples/learn/compat.py`` trains with it.
"""

import importlib.util
from typing import Any

import numpy as np
import protean_robotics as pr
import pytest

HERE = importlib.util.find_spec("stable_baselines3") is not None
needs_sb3 = pytest.mark.skipif(not HERE, reason="no package stable_baselines3")

#: An episode of 4 ticks.
SHORT: dict[str, Any] = {"scenario": "chase_exact", "set": {"rules.time_limit": 0.2}, "reward": {"time": -1.0}}


def both(agents: list[str]) -> tuple[Any, Any]:
    """Ours, and the library's own."""
    from stable_baselines3.common.vec_env import DummyVecEnv

    ours = pr.sb3.VecEnv(pr.VectorEnv(num_envs=3, agents=agents, **SHORT))
    return ours, DummyVecEnv([lambda: pr.Env(agents=agents, **SHORT)] * 3)


def assert_same(own: Any, expected: Any) -> None:
    assert type(own) is type(expected)
    if isinstance(expected, np.ndarray):
        assert own.dtype == expected.dtype and own.shape == expected.shape
        assert np.array_equal(own, expected)
    elif isinstance(expected, dict):
        assert own.keys() == expected.keys()
        for key, value in expected.items():
            assert_same(own[key], value)
    elif isinstance(expected, (list, tuple)):
        assert len(own) == len(expected)
        for one, other in zip(own, expected, strict=True):
            assert_same(one, other)
    else:
        assert own == expected


@pytest.mark.skipif(HERE, reason="the package stable_baselines3 is installed")
def test_without_the_library_the_error_names_the_extra() -> None:
    with pytest.raises(ImportError, match=r"stable_baselines3.*protean-robotics\[sb3\]"):
        _ = pr.sb3


@needs_sb3
@pytest.mark.parametrize("wrap", ["none", "VecMonitor", "VecNormalize", "VecFrameStack", "VecCheckNan"])
@pytest.mark.parametrize("agents", [["evader_1"], ["evader", "police_1"]])
def test_results_are_those_of_the_library_itself(agents: list[str], wrap: str) -> None:
    from stable_baselines3.common import vec_env

    wrappers: dict[str, Any] = {
        "none": lambda envs: envs,
        "VecFrameStack": lambda envs: vec_env.VecFrameStack(envs, 2),
        "VecCheckNan": lambda envs: vec_env.VecCheckNan(envs, raise_exception=True),
    }
    pair = [wrappers.get(wrap, getattr(vec_env, wrap, None))(envs) for envs in both(agents)]
    options = [{}, {"set": {"rules.time_limit": 0.15}}, {"set": {}}]
    results: list[list[Any]] = [[], []]
    for envs, result in zip(pair, results, strict=True):
        result.append(envs.seed(7))
        envs.set_options(options)
        result.append(envs.reset())
        random = np.random.default_rng(1)
        for _ in range(10):
            step = envs.step(random.uniform(-1, 1, (3, *envs.action_space.shape)).astype(np.float32))
            for info in step[3]:
                # Wall-clock time.
                info.get("episode", {}).pop("t", None)
            result.append((*step, [dict(info) for info in envs.unwrapped.reset_infos]))
        envs.set_options(None)
        result.append(envs.reset().shape)
        result.append(envs.env_method("digest", indices=[0, 2]))
        result.append(envs.get_attr("agents", indices=1))
        result.append(envs.env_is_wrapped(pr.VectorEnv))
        result.append([envs.has_attr("entries"), envs.has_attr("v_max")])
        envs.close()
    assert_same(results[0], results[1])


@needs_sb3
def test_the_library_trains_and_evaluates() -> None:
    from stable_baselines3 import PPO
    from stable_baselines3.common.evaluation import evaluate_policy
    from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

    envs = VecNormalize(VecMonitor(pr.sb3.VecEnv(pr.VectorEnv(num_envs=4, agents=["evader_1"], **SHORT))))
    model = PPO("MlpPolicy", envs, n_steps=16, batch_size=32, seed=1, device="cpu")
    model.learn(256)
    assert [round(episode["r"], 6) for episode in model.ep_info_buffer or []] == [-0.2] * 64
    assert evaluate_policy(model, envs, n_eval_episodes=4)[0] == pytest.approx(-0.2)


@needs_sb3
def test_what_does_not_fit_is_refused() -> None:
    for wrong in (
        pr.Env(agents=["evader_1"], **SHORT),
        pr.VectorEnv(agents=["evader_1"], autoreset_mode="NextStep", **SHORT),
    ):
        with pytest.raises(pr.InvalidInput, match="envs = .*: expected a VectorEnv with autoreset_mode SAME_STEP"):
            pr.sb3.VecEnv(wrong)  # type: ignore[arg-type, unused-ignore]
    envs = pr.sb3.VecEnv(pr.VectorEnv(agents=["evader_1"], **SHORT))
    envs.set_options({"v_max": 3})
    with pytest.raises(pr.InvalidInput, match="options: no option 'v_max': expected set"):
        envs.reset()
    with pytest.raises(pr.InvalidInput, match="set_attr: 'v_max'.*set_options"):
        envs.set_attr("v_max", 3)
    with pytest.raises(pr.InvalidInput, match="no actions: expected step_async"):
        envs.step_wait()
    with pytest.raises(pr.InvalidInput, match=r"actions of shape \(2,\): expected \(1, 2\)"):
        envs.set_options(None)
        envs.reset()
        envs.step(np.zeros(2, dtype=np.float32))
