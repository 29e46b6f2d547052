"""Environments in what Gymnasium and PettingZoo put around them: the same as Gymnasium's own vector of `pr.Env`."""

import gc
import importlib.util
import re
import warnings
from collections.abc import Callable
from copy import deepcopy
from typing import Any

import gymnasium
import numpy as np
import protean_robotics as pr
import pytest
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv
from gymnasium.wrappers import vector as wrappers
from pettingzoo.test import api_test, parallel_api_test, parallel_seed_test, seed_test
from pettingzoo.utils import parallel_to_aec

#: An episode of 4 ticks.
SHORT: dict[str, Any] = {"scenario": "chase_exact", "set": {"rules.time_limit": 0.2}, "reward": {"time": -1.0}}
SEEDS = [5, 7, 5]
MODES = list(AutoresetMode)

WRAPPERS: dict[str, Callable[[Any], Any]] = {
    "ClipAction": wrappers.ClipAction,
    "ClipReward": lambda env: wrappers.ClipReward(env, -0.01, 1.0),
    "DictInfoToList": wrappers.DictInfoToList,
    "DtypeObservation": lambda env: wrappers.DtypeObservation(env, np.float64),
    "FlattenObservation": wrappers.FlattenObservation,
    "NormalizeObservation": wrappers.NormalizeObservation,
    "NormalizeReward": wrappers.NormalizeReward,
    "RecordEpisodeStatistics": wrappers.RecordEpisodeStatistics,
    "RescaleAction": lambda env: wrappers.RescaleAction(env, 0.0, 1.0),
    "RescaleObservation": lambda env: wrappers.RescaleObservation(env, 0.0, 1.0),
    "ReshapeObservation": lambda env: wrappers.ReshapeObservation(env, (-1, 2)),
    "TransformAction": lambda env: wrappers.TransformAction(env, lambda actions: 0.5 * actions),
    "TransformObservation": lambda env: wrappers.TransformObservation(env, lambda observations: 0.5 * observations),
    "TransformReward": lambda env: wrappers.TransformReward(env, lambda rewards: 2.0 * rewards),
    "VectorizeTransformAction": lambda env: wrappers.VectorizeTransformAction(env, gymnasium.wrappers.ClipAction),
    "VectorizeTransformObservation": lambda env: wrappers.VectorizeTransformObservation(
        env, gymnasium.wrappers.FlattenObservation
    ),
    "VectorizeTransformReward": lambda env: wrappers.VectorizeTransformReward(
        env, gymnasium.wrappers.ClipReward, min_reward=-0.01, max_reward=1.0
    ),
}
NEED_PACKAGES: dict[str, tuple[str, Callable[[Any], Any]]] = {
    "ArrayConversion": ("array_api_compat", lambda env: wrappers.ArrayConversion(env, np, np)),
    "NumpyToTorch": ("torch", lambda env: wrappers.NumpyToTorch(env)),
}
NOT_APPLICABLE = {
    "FilterObservation": "it selects entries of Dict and Tuple spaces",
    "GrayscaleObservation": "observations are no images",
    "ResizeObservation": "observations are no images",
    "HumanRendering": "it opens a window for the frames that test_views.py tests",
    "RecordVideo": "test_views.py",
    "JaxToNumpy": "its environments return arrays of JAX",
    "JaxToTorch": "its environments return arrays of JAX",
}


def ours(agents: list[str], mode: AutoresetMode) -> Any:
    return pr.VectorEnv(num_envs=len(SEEDS), agents=agents, autoreset_mode=mode, **SHORT)


def of_gymnasium(agents: list[str], mode: AutoresetMode) -> Any:
    return SyncVectorEnv([lambda: pr.Env(agents=agents, **SHORT)] * len(SEEDS), autoreset_mode=mode)


def assert_same(own: Any, expected: Any, at: str = "") -> None:
    """Ours has what Gymnasium's has; it may have more."""
    assert type(own) is type(expected), at
    if isinstance(expected, dict):
        # Wall-clock time of an episode.
        for key in expected.keys() - {"t"}:
            assert_same(own[key], expected[key], f"{at}.{key}")
    elif isinstance(expected, (list, tuple)):
        assert len(own) == len(expected), at
        for i, (one, other) in enumerate(zip(own, expected, strict=True)):
            assert_same(one, other, f"{at}.{i}")
    elif isinstance(expected, np.ndarray) and expected.dtype == object:
        assert_same(own.tolist(), expected.tolist(), at)
    elif isinstance(expected, np.ndarray):
        assert own.dtype == expected.dtype and own.shape == expected.shape, at
        np.testing.assert_allclose(own, expected, rtol=1e-12, err_msg=at)
    else:
        assert own == expected, at


def history(env: Any, mode: AutoresetMode) -> list[Any]:
    """Results of ten steps, resets included."""
    results: list[Any] = [env.reset(seed=list(SEEDS))]
    random = np.random.default_rng(1)
    for _ in range(10):
        # Wrappers change their arrays later.
        results.append(deepcopy(env.step(random.uniform(-1, 1, env.action_space.shape).astype(np.float32))))
        _, _, terminations, truncations, _ = results[-1]
        ended = np.asarray(terminations | truncations)
        if mode is AutoresetMode.DISABLED and ended.any():
            # All in one, as an observation normaliser wants it.
            results.append(env.reset(options={"reset_mask": ended}))
    return results


def compare(wrap: Callable[[Any], Any], agents: list[str], mode: AutoresetMode) -> None:
    own, expected = ours(agents, mode), of_gymnasium(agents, mode)
    try:
        reference = wrap(expected)
    except Exception as error:  # What Gymnasium refuses itself.
        with pytest.raises(type(error)):
            wrap(own)
        return
    assert_same(history(wrap(own), mode), history(reference, mode))


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("agents", [["evader_1"], ["evader", "police_1"]])
def test_a_vector_env_is_that_of_gymnasium(agents: list[str], mode: AutoresetMode) -> None:
    compare(lambda env: env, agents, mode)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", WRAPPERS)
def test_a_wrapper_of_gymnasium_works_as_around_its_own(name: str, mode: AutoresetMode) -> None:
    for agents in (["evader_1"], ["evader", "police_1"]):
        compare(WRAPPERS[name], agents, mode)


@pytest.mark.parametrize("name", NEED_PACKAGES)
def test_a_wrapper_for_another_package_works(name: str) -> None:
    package, wrap = NEED_PACKAGES[name]
    for needed in (package, "array_api_compat"):
        if importlib.util.find_spec(needed) is None:
            pytest.skip(f"no package {needed}")
    env = wrap(ours(["evader_1"], AutoresetMode.NEXT_STEP))
    env.reset(seed=1)


def test_every_wrapper_of_gymnasium_is_tried_or_has_a_reason() -> None:
    assert {*WRAPPERS, *NEED_PACKAGES, *NOT_APPLICABLE} == {*wrappers.__all__}


@pytest.mark.parametrize("mode", ["NextStep", AutoresetMode.DISABLED])
def test_the_mode_is_in_the_metadata(mode: Any) -> None:
    env = pr.VectorEnv(num_envs=1, agents=["evader_1"], autoreset_mode=mode, **SHORT)
    assert env.metadata["autoreset_mode"] is AutoresetMode(mode)


def test_only_instances_of_the_mask_are_reset() -> None:
    envs = pr.VectorEnv(num_envs=3, agents=["evader_1"], seed=1, threads=2, **SHORT)
    with pytest.raises(pr.InvalidInput, match="reset of all"):
        envs.reset(options={"reset_mask": np.array([True, False, False])})
    first, _ = envs.reset()
    moved, *_ = envs.step(np.ones((3, 2), dtype=np.float32))
    mask = np.array([False, True, False])
    options = {"reset_mask": mask}
    observations, infos = envs.reset(seed=[0, 9, 0], options=options)
    assert np.array_equal(observations[[0, 2]], moved[[0, 2]]) and not np.array_equal(observations[1], moved[1])
    assert infos["_seed"].tolist() == mask.tolist() and infos["seed"][1] == envs.seeds[1]
    # Wrappers read the options after the environment.
    assert options["reset_mask"] is mask
    assert [envs.episode(i, running=True).actions.shape[0] for i in range(3)] == [1, 0, 1]
    # The seed of a list is that of the only instance.
    alone, _ = pr.Env(agents=["evader_1"], **SHORT).reset(seed=9)
    assert np.array_equal(observations[1], alone)
    for wrong in ([True], np.array([1, 0, 0]), np.zeros(3, dtype=bool), "all"):
        with pytest.raises(pr.InvalidInput, match="reset_mask = "):
            envs.reset(options={"reset_mask": wrong})
    for seeds in ([1, 2], [1, 2, -3], "abc", [1, 2, "x"]):
        with pytest.raises(pr.InvalidInput, match="seed = "):
            envs.reset(seed=seeds)  # type: ignore[arg-type]
    assert np.array_equal(envs.reset(seed=1)[0], first)


@pytest.mark.parametrize("make", [pr.Env, pr.VectorEnv, pr.parallel_env])
def test_unknown_options_are_refused(make: Any) -> None:
    env = make(agents=["evader_1"], **SHORT)
    with pytest.raises(pr.InvalidInput, match="options: no option 'teams.evader.limits.v_max'"):
        env.reset(seed=1, options={"teams.evader.limits.v_max": 5.0})


@pytest.mark.parametrize("agents", [["evader_1"], ["evader", "police_1"]])
def test_an_action_of_another_shape_is_refused_by_the_shape_that_the_user_sees(agents: list[str]) -> None:
    shape = (2,) if len(agents) == 1 else (3, 2)
    env = pr.Env(agents=agents, **SHORT)
    envs = pr.VectorEnv(num_envs=2, agents=agents, **SHORT)
    for own, name, expected in ((env, "action", shape), (envs, "actions", (2, *shape))):
        own.reset()
        # Too few, too many, and as many in another order or dimension.
        for wrong in ((), (1, *expected), expected[::-1] + (1,), (int(np.prod(expected)),) + (1,), (7,)):
            with pytest.raises(pr.InvalidInput, match=re.escape(f"{name} of shape {wrong}: expected {expected}")):
                own.step(np.zeros(wrong, dtype=np.float32))
        with pytest.raises(pr.InvalidInput, match=re.escape(f"{name} = 'left': expected numbers of shape {expected}")):
            own.step("left")  # type: ignore[arg-type]
        own.step(np.zeros(expected, dtype=np.float32))
    parallel = pr.parallel_env(agents=agents, **SHORT)
    parallel.reset()
    zeros = {name: np.zeros(2, dtype=np.float32) for name in parallel.agents}
    with pytest.raises(pr.InvalidInput, match=re.escape("actions: evader_1: shape (1, 2): expected (2,)")):
        parallel.step(zeros | {"evader_1": np.zeros((1, 2), dtype=np.float32)})
    parallel.step(zeros)


def test_a_closed_environment_is_refused_in_words() -> None:
    for threads in (1, 2):
        envs = pr.VectorEnv(num_envs=2, agents=["evader_1"], threads=threads, **SHORT)
        envs.reset()
        envs.close()
        envs.close()
        assert envs.closed
        for use in (envs.reset, lambda envs=envs: envs.step(np.zeros((2, 2))), lambda envs=envs: envs.digest(0)):
            with pytest.raises(pr.InvalidInput, match="environment is closed: expected a new one"):
                use()
    env, parallel = pr.Env(agents=["evader_1"], **SHORT), pr.parallel_env(agents=["evader_1"], **SHORT)
    for own in (env, parallel):
        own.reset()
        own.close()
    for use in (env.reset, lambda: env.step(np.zeros(2)), parallel.reset, lambda: parallel.step({}), parallel.digest):
        with pytest.raises(pr.InvalidInput, match="environment is closed: expected a new one"):
            use()


def test_a_refused_constructor_warns_of_nothing(recwarn: pytest.WarningsRecorder) -> None:
    # Gymnasium closes what is deleted.
    with pytest.raises(pr.InvalidInput):
        pr.VectorEnv(agents=["evader_9"])
    gc.collect()
    assert not [str(warning.message) for warning in recwarn]


def test_a_vector_calls_its_instances_as_gymnasium() -> None:
    own, expected = ours(["evader_1"], AutoresetMode.SAME_STEP), of_gymnasium(["evader_1"], AutoresetMode.SAME_STEP)
    for envs in (own, expected):
        envs.reset(seed=list(SEEDS))
        envs.step(np.ones((3, 2), dtype=np.float32))
    assert own.call("digest", running=True) == expected.call("digest", running=True)
    for name in ("action_space", "agents", "entries", "observation_space", "render_mode", "spec"):
        assert own.get_attr(name) == expected.get_attr(name)
    for name in ("v_max", "step", "_instances"):
        with pytest.raises(AttributeError, match=f"no attribute '{name}'"):
            own.call(name)


def test_a_parallel_env_has_a_state_of_one_shape() -> None:
    env = pr.parallel_env(agents=["evader", "police_1"], ticks_per_action=2, **SHORT)
    observations, _ = env.reset(seed=1)
    assert np.array_equal(env.state(), np.concatenate(list(observations.values())))
    steps = 0
    while env.agents:
        env.step({name: np.ones(2, dtype=np.float32) for name in env.agents})
        assert env.state() in env.state_space
        steps += 1
    assert steps == 2


def test_copies_differ_without_a_seed_and_agree_with_one() -> None:
    def firsts(**seed: Any) -> list[Any]:
        agents = {"agents": ["evader_1"]}
        return [
            pr.Env(**agents, **SHORT, **seed).reset()[0],
            pr.Env(**agents, **SHORT, **seed).reset()[0],
            pr.VectorEnv(num_envs=2, **agents, **SHORT, **seed).reset()[0][0],
            pr.parallel_env(**agents, **SHORT, **seed).reset()[0]["evader_1"],
            pr.parallel_env(**agents, **SHORT, **seed).reset()[0]["evader_1"],
        ]

    assert len({first.tobytes() for first in firsts()}) == 5
    assert len({first.tobytes() for first in firsts(seed=3)}) == 1
    observations, _ = AsyncVectorEnv([lambda: pr.Env(agents=["evader_1"], **SHORT)] * 3).reset()
    assert len({row.tobytes() for row in observations}) == 3


def test_a_step_after_the_end_is_refused() -> None:
    env = pr.Env(agents=["evader_1"], seed=1, **SHORT)
    env.reset()
    action = np.zeros(2, dtype=np.float32)
    while not env.step(action)[3]:
        pass
    ended = env.digest()
    assert env.digest(running=True) == ended
    with pytest.raises(pr.InvalidInput, match="episode has ended: expected a reset"):
        env.step(action)
    env.reset()
    env.step(action)
    assert env.digest() == ended


def test_parallel_envs_pass_the_tests_of_pettingzoo_without_a_warning() -> None:
    def make() -> Any:
        return pr.parallel_env(agents=["evader", "police_1"], **SHORT)

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parallel_api_test(make(), num_cycles=100)
        parallel_seed_test(make, num_cycles=20)
        seed_test(lambda: parallel_to_aec(make()), num_cycles=20)
        api_test(parallel_to_aec(make()), num_cycles=50)
