"""Your first policy: PPO learns to drive a robot to an exit.

    pip install 'WHEEL[gym]' stable-baselines3 onnx onnxscript  # WHEEL: README.md of the repository
    python train.py hello                                       # hello.csv, hello.onnx
"""

import csv
import sys
from typing import Any

import numpy as np
import protean_robotics as pr
import torch
from stable_baselines3 import PPO

GAMES: dict[str, dict[str, Any]] = {
    "hello": {
        "scenario": "hello",
        "set": {"robots.robot.start_jitter": {"x": 0.2, "y": 0.2, "theta": 3.0}},
        "agents": ["robot"],
        "observation": "state+path+potential",
        "ticks_per_action": 10,
        "reward": {"progress": 0.5},
    },
    "two_police": {
        "scenario": "two_police.toml",
        "agents": ["evader_1"],
        "observation": "state+path+potential",
        "ticks_per_action": 4,
        "reward": {"progress": 0.05},
    },
    "even": {
        "scenario": "even.toml",
        "agents": ["evader_1"],
        "observation": "state+path+potential",
        "action": "residual",
        "ticks_per_action": 4,
        "reward": {"progress": 0.05},
    },
}
STEPS = {"hello": 16_384, "two_police": 163_840, "even": 65_536}


def escapes(model: PPO, game: dict[str, Any], count: int = 24) -> tuple[int, list[int]]:
    """Plays an episode in each of many instances; returns how many robots escape, and the seeds of the episodes."""
    envs = pr.VectorEnv(num_envs=count, seed=9000, **game)
    observations, _ = envs.reset()
    seeds, outcomes = envs.seeds.tolist(), [""] * count
    while "" in outcomes:
        actions, _ = model.predict(observations, deterministic=True)
        observations, _, terminations, truncations, infos = envs.step(actions)
        for i in np.flatnonzero(terminations | truncations):
            outcomes[i] = outcomes[i] or infos["outcome"][i][0]
    return outcomes.count("escaped"), seeds


def export(model: PPO, path: str) -> None:
    """Writes the policy without its noise as ONNX."""
    policy = model.policy
    actor = torch.nn.Sequential(policy.mlp_extractor.policy_net, policy.action_net, torch.nn.Hardtanh(-1.0, 1.0))
    observation = torch.tensor(model.observation_space.sample()[None])
    torch.onnx.export(
        actor.eval(), (observation,), path, external_data=False, verbose=False,
        input_names=["observation"], output_names=["action"],
    )  # fmt: skip


def main(name: str) -> None:
    torch.set_num_threads(1)
    game = GAMES[name]
    envs = pr.sb3.VecEnv(pr.VectorEnv(num_envs=8, seed=1, **game))
    # Corrections begin small, around the field; other actions anywhere.
    start = {"log_std_init": -1.0 if game.get("action") == "residual" else 0.0}
    model = PPO("MlpPolicy", envs, n_steps=128, batch_size=256, device="cpu", seed=1, policy_kwargs=start)
    curve = [(0, escapes(model, game)[0])]
    while model.num_timesteps < STEPS[name]:
        model.learn(STEPS[name] // 16, reset_num_timesteps=False)
        curve.append((model.num_timesteps, escapes(model, game)[0]))
        print(f"{curve[-1][0]:6} steps: {curve[-1][1]:2} of 24 escape", flush=True)
    with open(f"{name}.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([("steps", "escapes"), *curve])
    export(model, f"{name}.onnx")


if __name__ == "__main__":
    main(sys.argv[1])
