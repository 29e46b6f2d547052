"""Instances of a scenario for learning, independent of the libraries whose environments they become."""

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import Environments, InvalidInput
from ._planner import Planner, placed
from ._program import overrides
from ._run import Run

#: Names of the status codes of an agent at the end of an episode.
OUTCOMES = ("active", "caught", "escaped", "goal_reached", "timed_out")


@dataclass(frozen=True)
class Episode:
    """A recorded episode.

    Attributes
    ----------
    seed
        Seed of the scenario, for ``run``.
    actions
        Actions of all steps, shape (steps, agents, 2); 0 for an agent out of the game.
    """

    seed: int
    actions: NDArray[np.float32]


@dataclass(frozen=True)
class Step:
    """A step of all instances, for a function that computes rewards.

    Its arrays are valid until the next step.

    Attributes
    ----------
    observations
        Observations after the step, also where an episode ended, shape (num_envs, agents, entries).
    actions
        Actions of the step, shape (num_envs, agents, 2).
    events
        Numbers of events by name ("escape", "caught", "capture", "lost", "arrival", "contact"), each of shape
        (num_envs, agents).
    rewards
        Rewards by the default weights, shape (num_envs, agents).
    terminated
        True where the rules ended the episode, shape (num_envs,).
    truncated
        True where the time limit ended it, shape (num_envs,).
    dt
        Length of the step (s).
    """

    observations: NDArray[np.float32]
    actions: NDArray[np.float32]
    events: Mapping[str, NDArray[np.float32]]
    rewards: NDArray[np.float64]
    terminated: NDArray[np.bool_]
    truncated: NDArray[np.bool_]
    dt: float


#: Weights by their names, or a function from a step to rewards of shape (num_envs, agents) or (num_envs,).
Reward = Mapping[str, float] | Callable[[Step], ArrayLike] | None


class Instances:
    """Instances with their rewards. The arrays are the same objects in all steps."""

    core: Environments
    agents: tuple[str, ...]
    entries: list[list[str]]
    shape: tuple[int, int, int]
    observations: NDArray[np.float32]
    final_observations: NDArray[np.float32]
    rewards: NDArray[np.float64]
    reward_sums: NDArray[np.float64]
    returns: NDArray[np.float64]
    terminated: NDArray[np.bool_]
    truncated: NDArray[np.bool_]
    statuses: NDArray[np.uint8]
    lengths: NDArray[np.uint64]
    seeds: NDArray[np.uint64]

    def __init__(
        self,
        scenario: str | os.PathLike[str],
        num_envs: int,
        *,
        agents: Sequence[str],
        observation: str,
        action: str,
        seed: int,
        ticks_per_action: int,
        threads: int,
        set: Mapping[str, Any] | None,
        reward: Reward,
        planners: Mapping[str, Planner] | None,
        allow_outside: bool,
    ) -> None:
        if isinstance(agents, str):
            raise InvalidInput(f"agents = {agents!r}: expected a list of names")
        self._reward = reward if callable(reward) else None
        weights = reward if isinstance(reward, Mapping) else {}
        self.core = core = Environments(
            os.fspath(scenario),
            overrides=overrides(set),
            agents=list(agents),
            observation=observation,
            action=action,
            instances=num_envs,
            seed=seed,
            ticks_per_action=ticks_per_action,
            threads=threads,
            weights=[(name, float(weight)) for name, weight in weights.items()],
            planners=placed(planners),
            allow_outside=allow_outside,
        )
        self.agents = tuple(core.agents)
        self.entries = core.entries
        self.shape = (num_envs, len(self.agents), 2)
        self.observations = core.observations
        self.final_observations = core.final_observations
        self.terminated, self.truncated = core.terminated, core.truncated
        self.statuses, self.lengths, self.seeds = core.statuses, core.lengths, core.seeds
        custom = self._reward is not None
        self.rewards = np.zeros_like(core.rewards) if custom else core.rewards
        self.reward_sums = np.zeros_like(core.reward_sums) if custom else core.reward_sums
        self.returns = np.zeros_like(core.returns) if custom else core.returns
        self._events = {name: core.events[:, :, index] for index, name in enumerate(core.event_names)}
        self._ended = np.zeros(num_envs, dtype=np.bool_)

    def reset(self, seed: int | None) -> None:
        """Begins new episodes: the first ones of a seed, or the next ones."""
        self.core.reset(seed)
        self.rewards[:] = 0.0
        self.returns[:] = 0.0
        self._ended[:] = False

    def step(self, actions: ArrayLike) -> bool:
        """Does a step; returns True if an episode ended."""
        given = np.ascontiguousarray(actions, dtype=np.float32)
        if given.size != self.shape[0] * self.shape[1] * 2:
            raise InvalidInput(f"actions of shape {given.shape}: expected {self.shape}")
        any_ended = self.core.step(given)
        if self._reward is not None:
            self._compute_rewards(self._reward, given.reshape(self.shape))
        return any_ended

    def ended(self) -> NDArray[np.bool_]:
        """Returns which episodes ended in the step, an array of its own."""
        return self.terminated | self.truncated

    def _compute_rewards(self, reward: Callable[[Step], ArrayLike], actions: NDArray[np.float32]) -> None:
        self.returns[self._ended] = 0.0
        self._ended = ended = self.ended()
        observations = self.observations
        if ended.any():
            observations = observations.copy()
            observations[ended] = self.final_observations[ended]
        step = Step(
            observations=observations,
            actions=actions,
            events=self._events,
            rewards=self.core.rewards,
            terminated=self.terminated,
            truncated=self.truncated,
            dt=self.core.dt,
        )
        rewards = np.asarray(reward(step), dtype=np.float64)
        if rewards.shape == self.shape[:1]:
            rewards = rewards[:, np.newaxis]
        if rewards.shape not in (self.shape[:2], (self.shape[0], 1)):
            raise InvalidInput(f"reward: an array of shape {rewards.shape}: expected {self.shape[:2]}")
        self.rewards[:] = rewards
        np.add.reduce(self.rewards, axis=1, out=self.reward_sums)
        self.returns += self.rewards

    def episode(self, i: int, running: bool) -> Episode:
        """Returns a recorded episode."""
        seed, actions = self.core.episode(i, running)
        return Episode(seed, actions)

    def replay(
        self, i: int, running: bool, out: str | os.PathLike[str] | None = None, force: bool = False
    ) -> Run:
        """Executes a recorded episode again as a run."""
        return Run(json.loads(self.core.replay(i, running, out, force)))


def outcome(status: int) -> str:
    """Returns the name of the status of an agent."""
    return OUTCOMES[status]
