"""Train an evader of the chasing game by PPO.

    python ppo.py  # ten minutes on two cores: evader.onnx, curve.csv, curve.svg

PPO is after Schulman et al. (2017), advantages after Schulman et al. (2016). Both evaders share one policy, which
chooses a push every `REPEAT` ticks; in every tick `evader_potential` steers with this push in its field. At the start the
push is 0, and the policy thus as good as `evader_potential`. Reward: 1 for an escape, -1 for a capture or the end of time.
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
REPEAT = 20  # ticks from one action to the next: `ticks_per_action` of the policy
INSTANCES, ROLLOUT = 64, 64  # instances, and actions of each between two updates
EPOCHS, BATCH = 4, 2048
LEARNING_RATE = 1e-3  # at the start; falls to 0
DISCOUNT, TRACE = 0.98, 0.95
CLIP, VALUE = 0.2, 0.5
EFFORT = 0.03  # cost of the square of the mean push: noise in the advantages does not lead far from `evader_potential`
HIDDEN = 128
NOISE = 0.5  # standard deviation of the actions at the start
WARM_UP = 0.05  # share of the time before the policy changes: the critic learns first
ACTIVE = 0  # place in an observation


class Policy(nn.Module):
    """Actor and critic. The actor is linear: it learns from few episodes."""

    def __init__(self, entries):
        super().__init__()
        self.actor = nn.Linear(entries, 2)
        nn.init.zeros_(self.actor.weight)
        nn.init.zeros_(self.actor.bias)
        self.critic = layers(entries, 1, gain=1.0)
        self.log_std = nn.Parameter(torch.full((2,), float(np.log(NOISE))))

    def forward(self, observation):
        return Normal(self.actor(observation), self.log_std.exp()), self.critic(observation).squeeze(-1)


def layers(inputs, outputs, gain):
    made = [nn.Linear(inputs, HIDDEN), nn.Linear(HIDDEN, HIDDEN), nn.Linear(HIDDEN, outputs)]
    for layer, scale in zip(made, (2**0.5, 2**0.5, gain), strict=True):
        nn.init.orthogonal_(layer.weight, scale)
        nn.init.zeros_(layer.bias)
    return nn.Sequential(made[0], nn.Tanh(), made[1], nn.Tanh(), made[2])


class Game:
    """The instances and the reward."""

    def __init__(self, seed):
        self.env = pr.VectorEnv(
            SCENARIO,
            INSTANCES,
            agents=["evader"],
            observation="state+way",
            action="push",
            ticks_per_action=REPEAT,
            seed=seed,
            threads=2,
            set=SETTINGS,
        )
        self.observations = self.env.reset(seed=seed)[0]
        self.ends = []  # of the last evaders: whether they escaped

    def step(self, actions):
        """Returns rewards and whether the evaders' part has ended."""
        active = self.observations[..., ACTIVE] > 0.5
        self.observations, _, terminated, truncated, infos = self.env.step(actions)
        gained = infos["rewards"]  # 1 for an escape, -1 for a capture
        over = (terminated | truncated)[:, None]
        ended = ~active | (gained != 0) | over
        self.ends = (self.ends + (gained[active & ended] > 0).tolist())[-2000:]
        return (gained - (active & over & (gained == 0))).astype(np.float32), ended


def collect(game, policy):
    """Plays `ROLLOUT` actions; returns observations, actions, log-probabilities, advantages and returns."""
    steps = []
    for _ in range(ROLLOUT):
        observations = torch.from_numpy(game.observations)
        with torch.no_grad():
            distribution, values = policy(observations)
            actions = distribution.sample()
            chances = distribution.log_prob(actions).sum(-1)
        rewards, ended = game.step(actions.clamp(-1, 1).numpy())
        steps.append((observations, actions, chances, values, torch.from_numpy(rewards), torch.from_numpy(ended)))
    observations, actions, chances, values, rewards, ended = map(torch.stack, zip(*steps, strict=True))
    with torch.no_grad():
        following = policy(torch.from_numpy(game.observations))[1]
    advantages, advantage = torch.zeros_like(values), torch.zeros_like(following)
    for t in reversed(range(ROLLOUT)):
        goes_on = (~ended[t]).float()
        error = rewards[t] + DISCOUNT * goes_on * following - values[t]
        advantage = error + DISCOUNT * TRACE * goes_on * advantage
        advantages[t], following = advantage, values[t]
    active = observations[..., ACTIVE] > 0.5
    return [part[active] for part in (observations, actions, chances, advantages, advantages + values)]


def update(policy, optimiser, samples, with_actor):
    """Improves the critic and, if `with_actor`, the policy by a batch of samples."""
    observations, actions, chances, advantages, returns = samples
    advantages = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
    for _ in range(EPOCHS):
        for batch in torch.randperm(len(returns)).split(BATCH):
            distribution, values = policy(observations[batch])
            ratio = (distribution.log_prob(actions[batch]).sum(-1) - chances[batch]).exp()
            gain = torch.min(ratio * advantages[batch], ratio.clamp(1 - CLIP, 1 + CLIP) * advantages[batch]).mean()
            loss = VALUE * (values - returns[batch]).square().mean()
            if with_actor:
                loss += EFFORT * distribution.mean.square().sum(-1).mean() - gain
            optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(policy.parameters(), 0.5)
            optimiser.step()


def train(minutes, seed):
    torch.manual_seed(seed)
    torch.set_num_threads(1)  # the networks are small
    game = Game(seed)
    policy = Policy(len(game.env.entries[0]))
    optimiser = torch.optim.Adam(policy.parameters(), LEARNING_RATE, eps=1e-5)
    curve, begin, ticks = [], time.monotonic(), 0
    while (spent := (time.monotonic() - begin) / 60) < minutes:
        optimiser.param_groups[0]["lr"] = LEARNING_RATE * (1 - spent / minutes)
        update(policy, optimiser, collect(game, policy), with_actor=spent > WARM_UP * minutes)
        ticks += ROLLOUT * REPEAT * INSTANCES
        escapes = float(np.mean(game.ends or [False]))
        curve.append((round(spent, 3), ticks, round(escapes, 4)))
        print(f"{spent:5.2f} min {ticks:9d} ticks: {100 * escapes:4.1f} % escape", flush=True)
    return policy, curve


def export(policy, path):
    """Writes the mean push, clamped to -1..1, as ONNX."""
    node = helper.make_node
    nodes = [
        node("Gemm", ["observation", "weight", "bias"], ["mean"], transB=1),
        node("Clip", ["mean", "low", "high"], ["action"]),
    ]
    constants = [numpy_helper.from_array(value.detach().numpy(), name) for name, value in policy.actor.named_parameters()]
    constants += [numpy_helper.from_array(np.float32(bound), name) for name, bound in (("low", -1), ("high", 1))]
    value = helper.make_tensor_value_info
    inputs = [value("observation", TensorProto.FLOAT, ["batch", policy.actor.in_features])]
    outputs = [value("action", TensorProto.FLOAT, ["batch", 2])]
    graph = helper.make_graph(nodes, "evader", inputs, outputs, constants)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    onnx.checker.check_model(model)
    path.write_bytes(model.SerializeToString())


def draw(curve, path):
    """Draws the share of escapes in training against time."""
    last = curve[-1][0]
    points = " ".join(f"{50 + 490 * minutes / last:.1f},{240 - 220 * share:.1f}" for minutes, _, share in curve)
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
        csv.writer(file, lineterminator="\n").writerows([("minutes", "ticks", "escapes"), *curve])
    draw(curve, FOLDER / "curve.svg")


if __name__ == "__main__":
    main()
