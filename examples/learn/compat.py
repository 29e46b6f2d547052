#!/usr/bin/env python3
"""The environments under stable-baselines3 and TorchRL: a short training and a rollout with each.

    pip install 'WHEEL[gym]' stable-baselines3 torchrl    # WHEEL: README.md of the repository
    examples/learn/compat.py
"""

import numpy as np
import protean_robotics as pr

#: One second of a chase.
SHORT = {"rules.time_limit": 1.0}


def stable_baselines3() -> None:
    """Trains with single environments, which the library puts together."""
    from stable_baselines3 import PPO
    from stable_baselines3.common.env_checker import check_env
    from stable_baselines3.common.monitor import Monitor
    from stable_baselines3.common.vec_env import DummyVecEnv

    check_env(pr.Env("chase_exact", agents=["evader_1"], set=SHORT))

    def make() -> Monitor:
        return Monitor(pr.Env("chase_exact", agents=["evader_1"], set=SHORT, reward={"time": -0.1}))

    envs = DummyVecEnv([make] * 4)
    model = PPO("MlpPolicy", envs, n_steps=64, batch_size=64, seed=1, device="cpu")
    model.learn(1024)
    episodes = [(episode["r"], episode["l"]) for episode in model.ep_info_buffer or []]
    # A second costs 0.1; the game lasts one second, 20 steps.
    assert episodes and all(abs(reward + 0.1) < 1e-5 and length == 20 for reward, length in episodes)
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


def main() -> None:
    np.random.seed(0)
    stable_baselines3()
    torchrl()


if __name__ == "__main__":
    main()
