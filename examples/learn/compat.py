#!/usr/bin/env python3
"""The environments under stable-baselines3 and TorchRL: a short training and a rollout with each.

    pip install 'WHEEL[gym,sb3]' torchrl    # WHEEL: README.md of the repository
    examples/learn/compat.py [--speed]

With ``--speed`` it compares the CPU time of a step of ``pr.sb3.VecEnv`` with that of stable-baselines3's own vector.
"""

import argparse
import time
from typing import Any

import numpy as np
import protean_robotics as pr

#: One second of a chase.
SHORT = {"rules.time_limit": 1.0}


def stable_baselines3() -> None:
    """Trains with a vector of environments, and compares it with the library's own vector of single ones."""
    from stable_baselines3 import PPO
    from stable_baselines3.common.env_checker import check_env
    from stable_baselines3.common.evaluation import evaluate_policy
    from stable_baselines3.common.vec_env import DummyVecEnv, VecMonitor, VecNormalize

    options: dict[str, Any] = {"agents": ["evader_1"], "set": SHORT, "reward": {"time": -0.1}}
    check_env(pr.Env("chase_exact", **options))

    ours = pr.sb3.VecEnv(pr.VectorEnv("chase_exact", 4, **options))
    theirs = DummyVecEnv([lambda: pr.Env("chase_exact", **options)] * 4)
    for envs in (ours, theirs):
        envs.seed(7)
        envs.set_options({"set": {"teams.evader.limits.v_max": 0.4}})
    assert np.array_equal(ours.reset(), theirs.reset())
    random = np.random.default_rng(1)
    for _ in range(50):
        actions = random.uniform(-1, 1, (4, 2)).astype(np.float32)
        steps = ours.step(actions), theirs.step(actions)
        for own, expected in zip(*(step[:3] for step in steps), strict=True):
            assert own.dtype == expected.dtype and np.array_equal(own, expected)
        for own, expected in zip(*(step[3] for step in steps), strict=True):
            assert np.array_equal(own.pop("terminal_observation", 0), expected.pop("terminal_observation", 0))
            assert own == expected
        assert ours.reset_infos == theirs.reset_infos
    assert ours.env_method("digest") == theirs.env_method("digest")

    envs = VecNormalize(VecMonitor(ours), norm_reward=False)
    model = PPO("MlpPolicy", envs, n_steps=64, batch_size=64, seed=1, device="cpu")
    model.learn(1024)
    episodes = [(episode["r"], episode["l"]) for episode in model.ep_info_buffer or []]
    # A second costs 0.1; the game lasts one second, 20 steps.
    assert episodes and all(abs(reward + 0.1) < 1e-5 and length == 20 for reward, length in episodes)
    mean, _ = evaluate_policy(model, envs, n_eval_episodes=4)
    assert abs(mean + 0.1) < 1e-5
    print(f"stable-baselines3: PPO, {model.num_timesteps} steps, {len(episodes)} episodes")


def torchrl() -> None:
    """Collects a rollout from the instances; the last observation of an ended episode is among the results."""
    from torchrl.envs import GymWrapper
    from torchrl.envs.utils import check_env_specs

    envs = pr.VectorEnv("chase_exact", 4, agents=["evader_1"], set=SHORT)
    wrapped = GymWrapper(envs)
    check_env_specs(wrapped)
    wrapped.set_seed(1)
    rollout = wrapped.rollout(30, break_when_any_done=False)
    done = rollout["next", "done"].squeeze(-1)
    assert done[:, 19].all(), "the time limit of 20 steps"
    # Entry 0 is 1 in the game: no longer at the end, again in the next episode.
    last = rollout["next", "observation"][:, 19, 0]
    first = rollout["observation"][:, 20, 0]
    assert (last == 0).all() and (first == 1).all()
    print(f"TorchRL: rollout of shape {tuple(rollout.shape)}, {int(done.sum())} episodes, final observations kept")


def speed() -> None:
    """Compares CPU times of steps of 64 instances."""
    from stable_baselines3.common.vec_env import DummyVecEnv

    for scenario, agents, steps in [("hello", ["robot"], 400), ("chase_exact", ["evader", "police"], 200)]:
        ours = pr.sb3.VecEnv(pr.VectorEnv(scenario, 64, agents=agents, seed=1))
        theirs = DummyVecEnv([lambda scenario=scenario, agents=agents: pr.Env(scenario, agents=agents, seed=1)] * 64)
        actions = np.zeros((64, *ours.action_space.shape), dtype=np.float32)
        times: tuple[list[float], list[float]] = [], []
        for envs in (ours, theirs):
            envs.reset()
        for _ in range(5):
            for envs, own in zip((ours, theirs), times, strict=True):
                before = time.process_time()
                for _ in range(steps):
                    envs.step(actions)
                own.append((time.process_time() - before) / steps / 64 * 1e6)
        own, expected = (min(each) for each in times)
        print(f"{scenario}: {own:.1f} µs of CPU a step, DummyVecEnv {expected:.1f} µs: {expected / own:.1f} times as much")


def main() -> None:
    parser = argparse.ArgumentParser(description="The environments under stable-baselines3 and TorchRL.")
    parser.add_argument("--speed", action="store_true", help="compare CPU times only")
    np.random.seed(0)
    if parser.parse_args().speed:
        speed()
    else:
        stable_baselines3()
        torchrl()


if __name__ == "__main__":
    main()
