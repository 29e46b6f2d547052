"""Train an evader of the chasing game by PPO.

    python ppo.py  # ten minutes on two cores: evader.onnx, curve.csv, curve.svg

PPO is after Schulman et al. (2017). Both evaders share one policy. At the start of a mission it sees where all robots are,
and chooses parameters of `evader_potential`, which steers until the end; the training begins with the default ones. A
step of the environments is thus a mission, and the advantage of an action is its reward less the mean reward of all: 1 for
an escape, -1 for a capture or the end of time.
"""

import argparse
import csv
import time
from pathlib import Path

import numpy as np
import onnx
import protean_robotics as pr
import torch
from onnx import TensorProto, helper, numpy_helper
from torch import nn
from torch.distributions import Normal

FOLDER = Path(__file__).parent
# Beliefs of fewer particles are quicker to compute. evaluate.toml compares on the scenario `chase` itself.
SCENARIO, SETTINGS = "chase", {"processes.perception.params.filter.particles": 100}
REPEAT = 4800  # ticks of a mission that lasts to the end of time: `ticks_per_action` of the policy
INSTANCES = 64  # missions between two updates
EPOCHS = 4
BIAS_RATE, WEIGHT_RATE = 2e-2, 5e-4  # learning rates at the start; they fall to 0
CLIP = 0.2
NOISE = 1.0  # standard deviation of the actions


class Policy(nn.Module):
    """Distribution of the actions. Its mean is linear in the observation: it learns from few missions."""

    def __init__(self, entries):
        super().__init__()
        self.mean = nn.Linear(entries, 2)
        nn.init.zeros_(self.mean.weight)
        nn.init.zeros_(self.mean.bias)

    def forward(self, observations):
        return Normal(self.mean(observations), NOISE)


def play(env, observations, policy):
    """Plays a mission in every instance; returns observations, actions, log-probabilities and rewards of all evaders."""
    observations = torch.from_numpy(observations)
    with torch.no_grad():
        distribution = policy(observations)
        actions = distribution.sample()
        chances = distribution.log_prob(actions).sum(-1)
    following, _, terminated, truncated, infos = env.step(actions.clamp(-1, 1).numpy())
    assert (terminated | truncated).all()
    rewards = torch.from_numpy(np.where(infos["rewards"] > 0, 1.0, -1.0).astype(np.float32))
    return following, [part.flatten(0, 1) for part in (observations, actions)] + [chances.flatten(), rewards.flatten()]


def update(policy, optimiser, samples):
    """Improves the policy by the missions of all instances."""
    observations, actions, chances, rewards = samples
    advantages = (rewards - rewards.mean()) / (rewards.std() + 1e-8)
    for _ in range(EPOCHS):
        ratio = (policy(observations).log_prob(actions).sum(-1) - chances).exp()
        loss = -torch.min(ratio * advantages, ratio.clamp(1 - CLIP, 1 + CLIP) * advantages).mean()
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()


def train(minutes, seed):
    torch.manual_seed(seed)
    torch.set_num_threads(1)  # the networks are small
    env = pr.VectorEnv(
        SCENARIO,
        INSTANCES,
        agents=["evader"],
        observation="state",
        action="tune",
        ticks_per_action=REPEAT,
        seed=seed,
        threads=2,
        set=SETTINGS,
    )
    observations = env.reset(seed=seed)[0]
    policy = Policy(len(env.entries[0]))
    begin = time.monotonic()
    rates = [{"params": [policy.mean.bias], "lr": BIAS_RATE}, {"params": [policy.mean.weight], "lr": WEIGHT_RATE}]
    optimiser = torch.optim.Adam(rates)
    schedule = torch.optim.lr_scheduler.LambdaLR(optimiser, lambda _: 1 - (time.monotonic() - begin) / 60 / minutes)
    curve, ends, missions = [], [], 0
    while (spent := (time.monotonic() - begin) / 60) < minutes:
        observations, samples = play(env, observations, policy)
        update(policy, optimiser, samples)
        schedule.step()
        missions += INSTANCES
        ends = (ends + (samples[-1] > 0).tolist())[-2000:]
        escapes = float(np.mean(ends))
        with torch.no_grad():
            mean = policy.mean(samples[0]).clamp(-1, 1).mean(0).tolist()
        curve.append((round(spent, 3), missions, round(escapes, 4), *(round(part, 3) for part in mean)))
        done = f"{spent:5.2f} min {missions:6d} missions"
        print(f"{done}: {100 * escapes:4.1f} % escape, action {mean[0]:5.2f} {mean[1]:5.2f}", flush=True)
    return policy, curve


def export(policy, path):
    """Writes the mean action, clamped to -1..1, as ONNX."""
    node = helper.make_node
    nodes = [
        node("Gemm", ["observation", "weight", "bias"], ["mean"], transB=1),
        node("Clip", ["mean", "low", "high"], ["action"]),
    ]
    constants = [
        numpy_helper.from_array(value.detach().numpy(), name) for name, value in policy.mean.named_parameters()
    ]
    constants += [numpy_helper.from_array(np.float32(bound), name) for name, bound in (("low", -1), ("high", 1))]
    value = helper.make_tensor_value_info
    inputs = [value("observation", TensorProto.FLOAT, ["batch", policy.mean.in_features])]
    outputs = [value("action", TensorProto.FLOAT, ["batch", 2])]
    graph = helper.make_graph(nodes, "evader", inputs, outputs, constants)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    onnx.checker.check_model(model)
    path.write_bytes(model.SerializeToString())


def draw(curve, path):
    """Draws the share of escapes in training against time."""
    last = curve[-1][0]
    points = " ".join(f"{50 + 490 * row[0] / last:.1f},{240 - 220 * row[2]:.1f}" for row in curve)
    lines = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 560 280" font-family="sans-serif" font-size="12">']
    lines += ['<rect width="560" height="280" fill="white"/>']
    for percent in range(0, 101, 25):
        y = 240 - 2.2 * percent
        lines += [f'<path d="M50 {y}H540" stroke="#ccc"/>']
        lines += [f'<text x="44" y="{y + 4}" text-anchor="end">{percent} %</text>']
    lines += [f'<polyline points="{points}" fill="none" stroke="#06c" stroke-width="2"/>']
    lines += [f'<text x="295" y="266" text-anchor="middle">escapes in training, 0 to {last:.1f} min</text></svg>']
    path.write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    policy, curve = train(options.minutes, options.seed)
    export(policy, FOLDER / "evader.onnx")
    with open(FOLDER / "curve.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(
            [("minutes", "missions", "escapes", "avoid_speed", "threat_gain"), *curve]
        )
    draw(curve, FOLDER / "curve.svg")


if __name__ == "__main__":
    main()
