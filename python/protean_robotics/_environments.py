"""Instances of a scenario for learning, independent of the libraries whose environments they become."""

import json
import os
import secrets
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments
from ._core import Environments, Variant
from ._errors import InvalidInput
from ._pickling import remade
from ._planner import placed
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
    before
        Observations before the step, shape (num_envs, agents, entries).
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

    before: NDArray[np.float32]
    observations: NDArray[np.float32]
    actions: NDArray[np.float32]
    events: Mapping[str, NDArray[np.float32]]
    rewards: NDArray[np.float64]
    terminated: NDArray[np.bool_]
    truncated: NDArray[np.bool_]
    dt: float


#: Weights by their names, or a function from a step to rewards of shape (num_envs, agents) or (num_envs,).
Reward = Mapping[str, float] | Callable[[Step], ArrayLike] | None


@remade
class Instances:
    """Instances with their rewards. The arrays are the same objects in all steps."""

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
    #: Where the last step ended an episode.
    ended: NDArray[np.bool_]
    #: Where the last step or reset began one.
    begun: NDArray[np.bool_]

    @_arguments.checked
    def __init__(
        self,
        scenario: str | os.PathLike[str],
        num_envs: int,
        *,
        agents: Sequence[str],
        observation: str,
        action: str,
        seed: int | None = None,
        autoreset_mode: str,
        ticks_per_action: int,
        threads: int,
        set: Mapping[str, Any] | None = None,
        reward: Reward,
        planners: Mapping[str, Callable[..., Any]] | None = None,
        record: bool,
        allow_outside: bool,
    ) -> None:
        self._reward = reward if callable(reward) else None
        weights = _weights({} if reward is None or callable(reward) else reward)
        self.scenario = scenario
        self._set = overrides(set)
        self._variants: dict[tuple[str, ...], Variant] = {}
        self._core: Environments | None = None
        self._core = core = Environments(
            os.fspath(scenario),
            overrides=self._set,
            agents=list(agents),
            observation=observation,
            action=action,
            instances=num_envs,
            # Without a seed, copies play different episodes.
            seed=secrets.randbits(63) if seed is None else seed,
            autoreset_mode=autoreset_mode,
            ticks_per_action=ticks_per_action,
            threads=threads,
            weights=weights,
            planners=placed(planners),
            record=record,
            allow_outside=allow_outside,
        )
        self._dt = core.dt
        self.agents = tuple(core.agents)
        self.entries = core.entries
        self.shape = (num_envs, len(self.agents), 2)
        self.observations = core.observations
        self.final_observations = core.final_observations
        self.terminated, self.truncated = core.terminated, core.truncated
        self.statuses, self.lengths, self.seeds = core.statuses, core.lengths, core.seeds
        self._default_rewards = core.rewards
        custom = self._reward is not None
        self.rewards = np.zeros_like(core.rewards) if custom else core.rewards
        self.reward_sums = np.zeros_like(core.reward_sums) if custom else core.reward_sums
        self.returns = np.zeros_like(core.returns) if custom else core.returns
        self._events = {name: core.events[:, :, index] for index, name in enumerate(core.event_names)}
        self._autoreset_mode = autoreset_mode
        self._none = np.zeros(num_envs, dtype=np.bool_)
        self._frame: tuple[int, int] | None = None
        self.ended = self._none
        self.begun = self._none

    @property
    def core(self) -> Environments:
        """The compiled part; refuses after `close`."""
        if self._core is None:
            raise InvalidInput("the environment is closed: expected a new one")
        return self._core

    def close(self) -> None:
        """Ends the threads and forgets the episodes."""
        self._core = None

    def reset(self, seed: Any, options: Mapping[str, Any] | None, known: Sequence[str] = ("set",)) -> None:
        """Begins new episodes: the first ones of a seed or of one for each instance, or the next ones."""
        count = self.shape[0]
        begun = np.ones(count, dtype=np.bool_)
        variants: list[Variant | None] = [None] * count
        for name, value in {} if options is None else _arguments.mapping("options", options).items():
            if name not in known:
                raise InvalidInput(f"options: no option {name!r}: expected {' or '.join(known)}")
            if name == "reset_mask":
                begun = _mask(value, count)
            if name == "set":
                variants = self._varied(value)
        firsts: list[tuple[int, int] | None] = [None] * count if seed is None else _seeds(seed, count)
        starts = zip(firsts, variants, begun, strict=True)
        self.core.reset_each([(first, variant) if begins else None for first, variant, begins in starts])
        self.rewards[begun] = 0.0
        self.returns[begun] = 0.0
        self.ended = self.ended & ~begun
        self.begun = begun

    def _varied(self, values: Any) -> list[Variant | None]:
        """Returns the scenarios of instances with other values: the same for all, or a mapping (or None) for each."""
        name, count = "options: set", self.shape[0]
        each = values if isinstance(values, (list, tuple)) else [values] * count
        if len(each) != count:
            raise _arguments.refused(name, values, f"a mapping of names to values, or a list of {count}")
        keys = [None if own is None else tuple(overrides(_arguments.mapping(name, own))) for own in each]
        # Those of the last reset are often those of the next one.
        known = self._variants
        self._variants = {
            key: known.get(key) or self.core.variant([*self._set, *key])
            for key in dict.fromkeys(keys)
            if key is not None
        }
        return [None if key is None else self._variants[key] for key in keys]

    def step(self, actions: ArrayLike, shape: tuple[int, ...] | None = None, name: str = "actions") -> bool:
        """Does a step with actions of the shape that the user sees; returns True if an episode ended."""
        shape = shape or self.shape
        try:
            given = np.asarray(actions, dtype=np.float32, order="C")
        except (TypeError, ValueError):
            raise _arguments.refused(name, actions, f"numbers of shape {shape}") from None
        if given.shape != shape:
            raise InvalidInput(f"{name} of shape {given.shape}: expected {shape}")
        before = self.ended
        observed = self.observations.copy() if self._reward is not None else None
        any_ended = self.core.step(given)
        self.ended = self.terminated | self.truncated if any_ended else self._none
        self.begun = {"NextStep": before, "SameStep": self.ended}.get(self._autoreset_mode, self._none)
        if self._reward is not None and observed is not None:
            self.returns[before] = 0.0
            self._compute_rewards(self._reward, observed, given.reshape(self.shape))
        return any_ended

    def _compute_rewards(
        self, reward: Callable[[Step], ArrayLike], before: NDArray[np.float32], actions: NDArray[np.float32]
    ) -> None:
        observations = self.observations
        in_same_step = self.begun & self.ended
        if in_same_step.any():
            observations = observations.copy()
            observations[in_same_step] = self.final_observations[in_same_step]
        step = Step(
            before=before,
            observations=observations,
            actions=actions,
            events=self._events,
            rewards=self._default_rewards,
            terminated=self.terminated,
            truncated=self.truncated,
            dt=self._dt,
        )
        returned = reward(step)
        try:
            rewards = np.asarray(returned, dtype=np.float64)
        except (TypeError, ValueError):
            raise _arguments.refused("reward", returned, f"numbers of shape {self.shape[:2]}") from None
        if rewards.shape == self.shape[:1]:
            rewards = rewards[:, np.newaxis]
        if rewards.shape not in (self.shape[:2], (self.shape[0], 1)):
            raise InvalidInput(f"reward: an array of shape {rewards.shape}: expected {self.shape[:2]}")
        self.rewards[:] = rewards
        # A step that only begins an episode has none.
        self.rewards[self.begun & ~self.ended] = 0.0
        np.add.reduce(self.rewards, axis=1, out=self.reward_sums)
        self.returns += self.rewards

    @_arguments.checked
    def episode(self, i: int, running: bool) -> Episode:
        """Returns a recorded episode."""
        seed, actions = self.core.episode(i, running)
        return Episode(seed, actions)

    @_arguments.checked
    def render(self, i: int) -> NDArray[np.uint8]:
        """Returns the picture of the running episode of an instance, of the size of the first picture of all."""
        picture = self.core.render(i, self._frame)
        if self._frame is None:
            self._frame = picture.shape[1] // 2 * 2, picture.shape[0] // 2 * 2
            picture = self.core.render(i, self._frame)
        return picture

    def metadata(self, **others: Any) -> dict[str, Any]:
        """Returns the metadata of the environments of all libraries."""
        return {"render_modes": ["rgb_array"], "render_fps": max(1, round(1 / self.core.dt)), **others}

    @_arguments.checked
    def replay(
        self, i: int, running: bool, out: str | os.PathLike[str] | None = None, force: bool = False
    ) -> Run:
        """Executes a recorded episode again as a run."""
        return Run(json.loads(self.core.replay(i, running, out, force)))


def render_mode(mode: Any) -> str | None:
    """Returns how environments are drawn."""
    if mode is not None and not (isinstance(mode, str) and mode == "rgb_array"):
        raise _arguments.refused("render_mode", mode, "None or 'rgb_array'; HumanRendering of Gymnasium shows its pictures")
    return "rgb_array" if mode else None


def _weights(reward: Any) -> list[tuple[str, float]]:
    """Returns the weights of rewards."""
    if not isinstance(reward, Mapping):
        raise _arguments.refused("reward", reward, "weights by their names, or a function from a Step to rewards")
    weights = _arguments.mapping("reward", reward).items()
    return [(name, _arguments.number(f"reward: {name}", weight)) for name, weight in weights]


def _mask(mask: Any, count: int) -> NDArray[np.bool_]:
    """Returns which instances to reset."""
    array = np.asarray(mask)
    if array.dtype != np.bool_ or array.shape != (count,) or not array.any():
        expected = f"an array of truth values of shape ({count},), at least one True"
        raise _arguments.refused("options: reset_mask", mask, expected)
    return array


def _seeds(seed: Any, count: int) -> list[tuple[int, int] | None]:
    """Returns seed and index for each instance: one seed for all, or one (or None: the next episode) for each."""
    if not isinstance(seed, (Sequence, np.ndarray)) or getattr(seed, "ndim", 1) == 0:
        return [(_arguments.seed("seed", seed), i) for i in range(count)]
    if isinstance(seed, (str, bytes)) or len(seed) != count:
        raise _arguments.refused("seed", seed, f"a seed, or a list of {count} seeds")
    return [None if own is None else (_arguments.seed("seed", own), 0) for own in seed]


def described(kind: str, scenario: str | os.PathLike[str], **values: Any) -> str:
    """Returns the text of an environment as in a notebook."""
    return f"{kind}({', '.join([repr(os.fspath(scenario)), *(f'{name}={value!r}' for name, value in values.items())])})"


def outcome(status: int) -> str:
    """Returns the name of the status of an agent."""
    return OUTCOMES[status]
