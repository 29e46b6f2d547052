"""Train an evader of the chasing game by PPO.

    python ppo.py  # ten minutes on two cores: evader.onnx, curve.csv, curve.svg

PPO is after Schulman et al. (2017), advantages after Schulman et al. (2016). Both evaders share one policy, which
chooses an action every `REPEAT` ticks. Reward: 1 for an escape, -1 for a capture or the end of time, and the progress
along the shortest way to the exit.
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
# Police that know all are quicker to compute than those with beliefs. evaluate.toml compares on the scenario `chase`.
SCENARIO = "chase_layouts"
SETTINGS = {"teams.evader.limits.v_max": 0.3}
REPEAT = 4  # ticks from one action to the next: `ticks_per_action` of the policy
INSTANCES, ROLLOUT = 64, 64  # instances, and actions of each between two updates
EPOCHS, BATCH = 3, 2048
LEARNING_RATE = 1e-3  # at the start; falls to 0
DISCOUNT, TRACE = 0.995, 0.95
CLIP, ENTROPY, VALUE = 0.2, 0.003, 0.5
HIDDEN = 128
WAVES = 5  # octaves of sines and cosines of the position
PROGRESS = 1 / 20  # reward of a way that is shorter by a metre (1/m)
EXIT, RADIUS = (9.2, 0.0), 0.15  # end of the shortest way, and the disc that drives it (m)
LOOK_AHEAD = 0.5  # (m)
# At first the policy also imitates a robot on the shortest way; the weight falls to 0 in this share of the time.
IMITATION, IMITATED = 1.0, 0.2
ACTIVE, X, Y, HEADING = 0, 1, 2, 3  # places in an observation


class Policy(nn.Module):
    """Actor and critic. Sines and cosines of the position resolve the streets of the map."""

    def __init__(self, observation):
        super().__init__()
        frequencies = 2.0 ** torch.arange(WAVES) * torch.pi / 2
        waves = torch.zeros(observation, 2 * WAVES)
        waves[X, :WAVES] = frequencies
        waves[Y, WAVES:] = frequencies
        self.register_buffer("waves", waves)
        inputs = observation + 4 * WAVES
        self.actor = layers(inputs, 2, gain=0.01)
        self.critic = layers(inputs, 1, gain=1.0)
        self.log_std = nn.Parameter(torch.full((2,), -0.5))

    def forward(self, observation):
        angles = observation @ self.waves
        features = torch.cat([observation, torch.sin(angles), torch.cos(angles)], -1)
        return Normal(self.actor(features), self.log_std.exp()), self.critic(features).squeeze(-1)


def layers(inputs, outputs, gain):
    made = [nn.Linear(inputs, HIDDEN), nn.Linear(HIDDEN, HIDDEN), nn.Linear(HIDDEN, outputs)]
    for layer, scale in zip(made, (2**0.5, 2**0.5, gain), strict=True):
        nn.init.orthogonal_(layer.weight, scale)
        nn.init.zeros_(layer.bias)
    return nn.Sequential(made[0], nn.Tanh(), made[1], nn.Tanh(), made[2])


class Way:
    """The shortest way to the exit, looked up by the position in an observation."""

    def __init__(self):
        world = pr.Map(SCENARIO)
        lengths = pr.navigation.arrival_times(world, EXIT, 1.0, RADIUS)
        self.size = lengths.shape[0]
        self.lengths = np.where(np.isfinite(lengths), lengths, 2 * lengths[np.isfinite(lengths)].max())
        # Direction to the place at a distance of LOOK_AHEAD from which the way is shortest.
        reach = round(LOOK_AHEAD / world.resolution)
        angles = np.arange(32) * np.pi / 16
        self.directions = np.stack([np.cos(angles), np.sin(angles)], -1).astype(np.float32)
        shifts = np.rint(reach * self.directions).astype(int)
        padded = np.pad(self.lengths, reach, constant_values=np.inf)
        shifted = [padded[reach + y :, reach + x :][: self.size, : self.size] for x, y in shifts]
        self.best = np.argmin(shifted, axis=0)

    def place(self, observations):
        places = ((observations[..., [Y, X]] + 1) / 2 * self.size).astype(int).clip(0, self.size - 1)
        return places[..., 0], places[..., 1]

    def length(self, observations):
        """Length of the way (m)."""
        return self.lengths[self.place(observations)]

    def action(self, observations):
        """The action that follows the way."""
        x, y = np.moveaxis(self.directions[self.best[self.place(observations)]], -1, 0)
        cos, sin = observations[..., HEADING], observations[..., HEADING + 1]
        ahead, left = cos * x + sin * y, cos * y - sin * x
        turn = np.where(ahead > 0, (2 * left).clip(-1, 1), np.sign(left))
        return np.stack([ahead.clip(0, 1), turn], -1).astype(np.float32)


class Game:
    """The instances, with an action every `REPEAT` ticks, and the reward."""

    def __init__(self, seed):
        self.env = pr.VectorEnv(
            SCENARIO, INSTANCES, agents=["evader"], observation="state", seed=seed, threads=2, set=SETTINGS
        )
        self.way = Way()
        self.observations = self.env.reset(seed=seed)[0].copy()
        self.ends = []  # of the last evaders: whether they escaped

    def step(self, actions):
        """Returns rewards and whether the evaders' part has ended."""
        before = self.way.length(self.observations)
        active = self.observations[..., ACTIVE] > 0.5
        rewards, ended = np.zeros(active.shape, np.float32), ~active
        for _ in range(REPEAT):
            observations, _, terminated, truncated, infos = self.env.step(actions)
            gained = infos["rewards"]  # 1 for an escape, -1 for a capture
            ends = ~ended & ((gained != 0) | (terminated | truncated)[:, None])
            rewards += np.where(ended, 0.0, gained) - (ends & (gained == 0))
            self.ends += (gained[ends] > 0).tolist()
            ended |= ends
        self.ends = self.ends[-2000:]
        self.observations = observations.copy()
        nearer = before - DISCOUNT * self.way.length(self.observations)
        rewards += np.where(ended, 0.0, PROGRESS * nearer)
        return rewards, ended


def collect(game, policy):
    """Plays `ROLLOUT` actions; returns observations, actions, log-probabilities, advantages, returns and examples."""
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
    shown = torch.from_numpy(game.way.action(observations.numpy()))
    return [part[active] for part in (observations, actions, chances, advantages, advantages + values, shown)]


def update(policy, optimiser, samples, imitation):
    """Improves the policy by a batch of samples; `imitation` is the weight of the actions to imitate."""
    observations, actions, chances, advantages, returns, shown = samples
    advantages = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
    for _ in range(EPOCHS):
        for batch in torch.randperm(len(returns)).split(BATCH):
            distribution, values = policy(observations[batch])
            ratio = (distribution.log_prob(actions[batch]).sum(-1) - chances[batch]).exp()
            gain = torch.min(ratio * advantages[batch], ratio.clamp(1 - CLIP, 1 + CLIP) * advantages[batch]).mean()
            error = (values - returns[batch]).square().mean()
            loss = VALUE * error - gain - ENTROPY * distribution.entropy().sum(-1).mean()
            loss = loss + imitation * (distribution.mean - shown[batch]).square().mean()
            optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(policy.parameters(), 0.5)
            optimiser.step()


def train(minutes, seed):
    torch.manual_seed(seed)
    torch.set_num_threads(1)  # the network is small
    game = Game(seed)
    policy = Policy(game.observations.shape[-1])
    optimiser = torch.optim.Adam(policy.parameters(), LEARNING_RATE, eps=1e-5)
    curve, begin, updates = [], time.monotonic(), 0
    while (spent := (time.monotonic() - begin) / 60) < minutes:
        optimiser.param_groups[0]["lr"] = LEARNING_RATE * (1 - spent / minutes)
        imitation = IMITATION * max(0.0, 1 - spent / (IMITATED * minutes))
        update(policy, optimiser, collect(game, policy), imitation)
        updates += 1
        ticks, escapes = updates * ROLLOUT * REPEAT * INSTANCES, float(np.mean(game.ends or [False]))
        curve.append((round(spent, 3), ticks, round(escapes, 4)))
        if updates % 10 == 0:
            print(f"{spent:5.2f} min {ticks:10d} ticks {100 * escapes:5.1f} % escape in training", flush=True)
    return policy, curve


def export(policy, path):
    """Writes the mean action, clamped to -1..1, as ONNX."""
    weights = {"waves": policy.waves}
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
        node("Gemm", ["hidden2", "weight4", "bias4"], ["mean"], transB=1),
        node("Clip", ["mean", "low", "high"], ["action"]),
    ]
    constants = [numpy_helper.from_array(value.detach().numpy(), name) for name, value in weights.items()]
    constants += [numpy_helper.from_array(np.float32(bound), name) for name, bound in (("low", -1), ("high", 1))]
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
