"""Values of the scenario for the episodes that a reset begins: ``options={"set": …}``."""

from pathlib import Path
from typing import Any

import numpy as np
import protean_robotics as pr
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

#: An episode of 10 ticks, in whose place values give one of 4.
BASE: dict[str, Any] = {"scenario": "chase_exact", "set": {"rules.time_limit": 0.5}}
VALUES = {"rules.time_limit": 0.2, "teams.evader.limits.v_max": 0.2}
OPTIONS = {"set": VALUES}
ACTION = np.array([1.0, 0.3], dtype=np.float32)


def length(env: pr.Env) -> int:
    """Number of steps until the end."""
    steps = 1
    while not env.step(ACTION)[3]:
        steps += 1
    return steps


@pytest.mark.parametrize("agents", [["evader_1"], ["evader", "police"]])
def test_an_episode_is_that_of_an_environment_with_these_values(agents: list[str], tmp_path: Path) -> None:
    env = pr.Env(agents=agents, **BASE)
    expected = pr.Env(agents=agents, scenario="chase_exact", set=VALUES)
    actions = env.action_space
    actions.seed(1)
    first, second = env.reset(seed=3, options=OPTIONS)[0], expected.reset(seed=3)[0]
    ended = False
    while not ended:
        assert np.array_equal(first, second)
        action = actions.sample()
        first, _, _, ended, _ = env.step(action)
        second = expected.step(action)[0]
    digest = env.digest()
    assert digest == expected.digest()
    # Also when later episodes have others.
    env.reset(options={"set": {}})
    run = env.save_log(tmp_path / "episode.mcap")
    assert run.digest == digest and run.log is not None and run.log.topics["world/state"] == 5


def test_values_hold_until_another_reset_gives_some() -> None:
    env = pr.Env(agents=["evader_1"], **BASE)
    lengths = []
    for options in (None, OPTIONS, None, {}, {"set": {"teams.evader.limits.v_max": 0.2}}, {"set": VALUES}, {"set": {}}):
        env.reset(options=options)
        lengths.append(length(env))
    assert lengths == [10, 4, 4, 4, 10, 4, 10]
    # PettingZoo resets as often.
    parallel = pr.parallel_env(agents=["evader_1"], **BASE)
    parallel.reset(seed=3, options=OPTIONS)
    for _ in range(4):
        *_, truncations, _ = parallel.step({"evader_1": ACTION})
    assert truncations == {"evader_1": True}


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_a_vector_has_values_for_all_or_for_each(mode: AutoresetMode) -> None:
    for threads in (1, 2):
        envs = pr.VectorEnv(num_envs=3, agents=["evader_1"], autoreset_mode=mode, threads=threads, **BASE)
        of_gymnasium = SyncVectorEnv([lambda: pr.Env(agents=["evader_1"], **BASE)] * 3, autoreset_mode=mode)
        for options in (OPTIONS, None):
            first, _ = envs.reset(seed=[1, 2, 3], options=options)
            assert np.array_equal(first, of_gymnasium.reset(seed=[1, 2, 3], options=options)[0])
            for _ in range(4):
                steps = [own.step(np.tile(ACTION, (3, 1))) for own in (envs, of_gymnasium)]
                assert all(np.array_equal(one, other) for one, other in zip(*(s[:4] for s in steps), strict=True))
            assert steps[0][3].all()
    envs.reset(options={"set": [None, {}, {"rules.time_limit": 0.1}]})
    ends = [envs.step(np.tile(ACTION, (3, 1)))[3].tolist() for _ in range(2)]
    assert ends == [[False, False, False], [False, False, True]]


def test_a_mask_keeps_the_values_of_the_others() -> None:
    envs = pr.VectorEnv(num_envs=3, agents=["evader_1"], seed=1, **BASE)
    envs.reset()
    mask = np.array([False, True, True])
    envs.reset(options={"reset_mask": mask, "set": [{"rules.time_limit": 0.1}, VALUES, None]})
    ends = np.array([envs.step(np.tile(ACTION, (3, 1)))[3] for _ in range(10)])
    assert [np.flatnonzero(own).tolist() for own in ends.T] == [[9], [3, 7], [9]]


def test_values_that_do_not_fit_are_refused_and_change_nothing() -> None:
    envs = pr.VectorEnv(num_envs=2, agents=["evader_1"], seed=1, **BASE)
    first, _ = envs.reset()
    for values, text in [
        (3, "options: set = 3: expected a mapping"),
        ([VALUES], "a list of 2"),
        ([VALUES, 3], "options: set = 3"),
        ({"rules.time_limit": object()}, "set: rules.time_limit = "),
        ({"rules.time_limit": -1}, "time_limit"),
        ({"rules.time_limits": 1}, "time_limits"),
        ({"run.dt": 0.1}, "change the time step: expected new environments"),
    ]:
        with pytest.raises(pr.InvalidInput, match=text):
            envs.reset(options={"set": values})
    moved, *_ = envs.step(np.tile(ACTION, (2, 1)))
    again = pr.VectorEnv(num_envs=2, agents=["evader_1"], seed=1, **BASE)
    assert np.array_equal(again.reset()[0], first)
    assert np.array_equal(again.step(np.tile(ACTION, (2, 1)))[0], moved)
