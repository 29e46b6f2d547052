"""Train an evader of the chasing game by PPO.

    python ppo.py  # ten minutes on two cores: evader.onnx, curve.csv, curve.svg

PPO is after Schulman et al. (2017), advantages after Schulman et al. (2016). Both evaders share one policy, which
chooses an action every `REPEAT` ticks. Its mean action is the way past the Police and the push away from them, both of
which the observation contains, and what a network adds to it. Reward: 1 for an escape, -1 for a capture or the end of time, and
the progress along the shortest way to the exit.
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
# Scenario, values in it, and share of the time. Police that know all are quicker to compute than those with beliefs, and
# beliefs of fewer particles quicker than those of many. evaluate.toml compares on the scenario `chase` itself.
STAGES = [
    ("chase_layouts", {"teams.evader.limits.v_max": 0.3}, 0.4),
    ("chase", {"processes.perception.params.filter.particles": 100}, 0.6),
]
REPEAT = 4  # ticks from one action to the next: `ticks_per_action` of the policy
INSTANCES, ROLLOUT = 64, 64  # instances, and actions of each between two updates
EPOCHS, BATCH = 4, 2048
LEARNING_RATE = 5e-4  # at the start; falls to 0
DISCOUNT, TRACE = 0.997, 0.95
CLIP, VALUE = 0.2, 0.5
HIDDEN = 128
LIMIT = 1.3  # of the action along the way: above 1, so that noise does not make the robot slower
AVOID = 4.0  # weight of the places where the Police can be soon
NOISE = 0.2  # standard deviation of the actions at the start
WAVES = 5  # octaves of sines and cosines of the position
PROGRESS = 0.02  # reward of a way that is shorter by a metre (1/m)
ACTIVE, X, Y = 0, 1, 2  # places in an observation


class Policy(nn.Module):
    """Actor and critic. Sines and cosines of the position resolve the streets of the map."""

    def __init__(self, entries):
        super().__init__()
        frequencies = 2.0 ** torch.arange(WAVES) * torch.pi / 2
        waves = torch.zeros(len(entries), 2 * WAVES)
        waves[X, :WAVES] = frequencies
        waves[Y, WAVES:] = frequencies
        self.register_buffer("waves", waves)
        # Ahead and to the left: along the way, and away from the Police.
        along = torch.zeros(len(entries), 2)
        along[entries.index("past.bearing_cos"), 0] = 2.0
        along[entries.index("past.bearing_sin"), 1] = 2.0
        for k in range(8):
            direction = torch.tensor([np.cos(k * np.pi / 4), np.sin(k * np.pi / 4)])
            along[entries.index(f"around.{k}.danger")] = -AVOID * direction
        self.register_buffer("along", along)
        inputs = len(entries) + 4 * WAVES
        self.actor = layers(inputs, 2, gain=0.01)
        self.critic = layers(inputs, 1, gain=1.0)
        self.log_std = nn.Parameter(torch.full((2,), float(np.log(NOISE))))

    def forward(self, observation):
        angles = observation @ self.waves
        features = torch.cat([observation, torch.sin(angles), torch.cos(angles)], -1)
        mean = (observation @ self.along).clamp(-LIMIT, LIMIT) + self.actor(features)
        return Normal(mean, self.log_std.exp()), self.critic(features).squeeze(-1)


def layers(inputs, outputs, gain):
    made = [nn.Linear(inputs, HIDDEN), nn.Linear(HIDDEN, HIDDEN), nn.Linear(HIDDEN, outputs)]
    for layer, scale in zip(made, (2**0.5, 2**0.5, gain), strict=True):
        nn.init.orthogonal_(layer.weight, scale)
        nn.init.zeros_(layer.bias)
    return nn.Sequential(made[0], nn.Tanh(), made[1], nn.Tanh(), made[2])


class Game:
    """The instances and the reward."""

    def __init__(self, scenario, settings, seed):
        self.env = pr.VectorEnv(
            scenario,
            INSTANCES,
            agents=["evader"],
            observation="state+way",
            ticks_per_action=REPEAT,
            seed=seed,
            threads=2,
            set=settings,
        )
        self.entries = self.env.entries[0]
        self.proximity = self.entries.index("way.proximity")
        self.observations = self.env.reset(seed=seed)[0]
        self.ends = []  # of the last evaders: whether they escaped

    def length(self):
        """Length of the shortest way to the exit (m)."""
        return 1 / np.maximum(self.observations[..., self.proximity], 0.01) - 1

    def step(self, actions):
        """Returns rewards and whether the evaders' part has ended."""
        active, before = self.observations[..., ACTIVE] > 0.5, self.length()
        self.observations, _, terminated, truncated, infos = self.env.step(actions)
        gained = infos["rewards"]  # 1 for an escape, -1 for a capture
        over = (terminated | truncated)[:, None]
        ended = ~active | (gained != 0) | over
        self.ends = (self.ends + (gained[active & ended] > 0).tolist())[-2000:]
        # The way of an evader whose part has ended is that of the next episode.
        nearer = np.where(ended, 0.0, before - DISCOUNT * self.length())
        return (gained - (active & over & (gained == 0)) + PROGRESS * nearer).astype(np.float32), ended


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


def update(policy, optimiser, samples):
    """Improves the policy by a batch of samples."""
    observations, actions, chances, advantages, returns = samples
    advantages = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
    for _ in range(EPOCHS):
        for batch in torch.randperm(len(returns)).split(BATCH):
            distribution, values = policy(observations[batch])
            ratio = (distribution.log_prob(actions[batch]).sum(-1) - chances[batch]).exp()
            gain = torch.min(ratio * advantages[batch], ratio.clamp(1 - CLIP, 1 + CLIP) * advantages[batch]).mean()
            loss = VALUE * (values - returns[batch]).square().mean() - gain
            optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(policy.parameters(), 0.5)
            optimiser.step()


def train(minutes, seed):
    torch.manual_seed(seed)
    torch.set_num_threads(1)  # the network is small
    policy, curve, begin, end, ticks = None, [], time.monotonic(), 0.0, 0
    for scenario, settings, share in STAGES:
        game = Game(scenario, settings, seed)
        if policy is None:
            policy = Policy(game.entries)
            optimiser = torch.optim.Adam(policy.parameters(), LEARNING_RATE, eps=1e-5)
        end += share * minutes
        while (spent := (time.monotonic() - begin) / 60) < end:
            optimiser.param_groups[0]["lr"] = LEARNING_RATE * (1 - spent / minutes)
            update(policy, optimiser, collect(game, policy))
            ticks += ROLLOUT * REPEAT * INSTANCES
            escapes = float(np.mean(game.ends or [False]))
            curve.append((round(spent, 3), ticks, round(escapes, 4)))
            print(f"{spent:5.2f} min {ticks:9d} ticks {scenario}: {100 * escapes:4.1f} % escape", flush=True)
    return policy, curve


def export(policy, path):
    """Writes the mean action, clamped to -1..1, as ONNX."""
    weights = {"waves": policy.waves, "along": policy.along}
    for layer in (0, 2, 4):
        weights |= {f"{name}{layer}": value for name, value in policy.actor[layer].named_parameters()}
    node = helper.make_node
    nodes = [
        node("MatMul", ["observation", "waves"], ["angles"]),
        node("Sin", ["angles"], ["sines"]),
        node("Cos", ["angles"], ["cosines"]),
        node("Concat", ["observation", "sines", "cosines"], ["features"], axis=-1),
        node("Gemm", ["features", "weight0", "bias0"], ["sum0"], transB=1),
        node("Tanh", ["sum0"], ["hidden0"]),
        node("Gemm", ["hidden0", "weight2", "bias2"], ["sum2"], transB=1),
        node("Tanh", ["sum2"], ["hidden2"]),
        node("Gemm", ["hidden2", "weight4", "bias4"], ["added"], transB=1),
        node("MatMul", ["observation", "along"], ["ahead_left"]),
        node("Clip", ["ahead_left", "least", "most"], ["base"]),
        node("Add", ["base", "added"], ["mean"]),
        node("Clip", ["mean", "low", "high"], ["action"]),
    ]
    constants = [numpy_helper.from_array(value.detach().numpy(), name) for name, value in weights.items()]
    bounds = {"least": -LIMIT, "most": LIMIT, "low": -1, "high": 1}
    constants += [numpy_helper.from_array(np.float32(bound), name) for name, bound in bounds.items()]
    value = helper.make_tensor_value_info
    inputs = [value("observation", TensorProto.FLOAT, ["batch", policy.waves.shape[0]])]
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
