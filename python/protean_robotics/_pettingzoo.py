"""Environments of PettingZoo."""

import os
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium.spaces import Space
from numpy.typing import NDArray

from . import _arguments
from ._environments import OUTCOMES, Episode, Instances, Reward, described, outcome, render_mode as checked_mode
from ._errors import InvalidInput
from ._gymnasium import box
from ._pickling import remade
from ._run import Run

if TYPE_CHECKING:
    # The package has no types.
    _ParallelEnv = object
else:
    from pettingzoo import ParallelEnv as _ParallelEnv

_TIMED_OUT = OUTCOMES.index("timed_out")


@remade
class ParallelEnv(_ParallelEnv):
    """One instance of a scenario with one learner per agent, after PettingZoo's ``ParallelEnv``.

    ``parallel_env`` makes it. An agent leaves with its last step in the game: it terminates when it is caught, escapes,
    arrives, or the mission is decided, and is truncated by the time limit.
    """

    metadata: dict[str, Any]
    render_mode: str | None
    possible_agents: list[str]
    agents: list[str]
    observation_spaces: dict[str, Space[NDArray[np.float32]]]
    action_spaces: dict[str, Space[NDArray[np.float32]]]
    state_space: Space[NDArray[np.float32]]

    def __init__(self, instances: Instances, render_mode: str | None = None) -> None:
        self._instances = instances
        self.metadata = instances.metadata(name="protean", is_parallelizable=True)
        self.render_mode = render_mode
        self.possible_agents = list(instances.agents)
        self.agents = []
        self._rows = {name: row for row, name in enumerate(instances.agents)}
        lengths = [len(names) for names in instances.entries]
        self.observation_spaces = {name: box((lengths[row],)) for name, row in self._rows.items()}
        self.action_spaces = {name: box((2,)) for name in instances.agents}
        self.state_space = box((sum(lengths),))
        self._actions = np.zeros((1, len(instances.agents), 2), dtype=np.float32)

    def observation_space(self, agent: str) -> Space[NDArray[np.float32]]:
        """Space of the observations of an agent.

        Parameters
        ----------
        agent
            Name of the agent.
        """
        return self.observation_spaces[self._known(agent)]

    def action_space(self, agent: str) -> Space[NDArray[np.float32]]:
        """Space of the actions of an agent.

        Parameters
        ----------
        agent
            Name of the agent.
        """
        return self.action_spaces[self._known(agent)]

    def _known(self, agent: str) -> str:
        if not isinstance(agent, str) or agent not in self.possible_agents:
            raise _arguments.refused("agent", agent, ", ".join(self.possible_agents))
        return agent

    def __repr__(self) -> str:
        return described("ParallelEnv", self._instances.scenario, agents=self.possible_agents)

    def state(self) -> NDArray[np.float32]:
        """Observations of all agents after the last step or reset, one after the other, for a central critic.

        Those out of the game are among them, so that its shape is that of ``state_space``.
        """
        rows = zip(self._instances.observations[0], self._instances.entries, strict=True)
        return np.concatenate([row[: len(names)] for row, names in rows])

    @property
    def entries(self) -> dict[str, list[str]]:
        """Names of the entries of the observation of each agent."""
        return {name: self._instances.entries[row] for name, row in self._rows.items()}

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, NDArray[np.float32]], dict[str, dict[str, Any]]]:
        """Begins a new episode.

        Parameters
        ----------
        seed
            Seed of all episodes from now on; None for the next episode.
        options
            ``{"set": {"teams.evader.limits.v_max": 0.5}}`` gives this and all following episodes other values of the
            scenario, in addition to the parameter ``set``, until another reset gives some. Agents and observations
            must stay the same.

        Returns
        -------
        observations
            First observations.
        infos
            The seed of the scenario of the episode ("seed").
        """
        # PettingZoo's own test gives `options`, which no environment knows.
        seed = None if seed is None else _arguments.seed("seed", seed)
        self._instances.reset(seed, options, known=("set", "options"))
        self.agents = list(self.possible_agents)
        seed = int(self._instances.seeds[0])
        return self._observed(self._instances.observations), {name: {"seed": seed} for name in self.agents}

    def step(
        self, actions: dict[str, NDArray[np.float32]]
    ) -> tuple[
        dict[str, NDArray[np.float32]],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """Does a step.

        Parameters
        ----------
        actions
            Action of each agent in the game, clamped to -1..1.

        Returns
        -------
        observations
            Observations after the step.
        rewards
            Rewards.
        terminations
            True for agents that the rules end.
        truncations
            True for agents that the time limit ends.
        infos
            Of agents that leave: their "outcome".
        """
        instances = self._instances
        if instances.core and not self.agents:
            return {}, {}, {}, {}, {}
        self._actions[:] = 0.0
        for name, action in _arguments.mapping("actions", actions).items():
            if self._known(name) in self.agents:
                self._actions[0, self._rows[name]] = _action(name, action)
        missing = [name for name in self.agents if name not in actions]
        if missing:
            raise InvalidInput(f"actions: none of {', '.join(missing)}: expected one of each agent in the game")
        ended = instances.step(self._actions)
        observations = self._observed(instances.observations)
        truncated = bool(instances.truncated[0])
        rewards, terminations, truncations, infos = {}, {}, {}, {}
        for name in self.agents:
            row = self._rows[name]
            status = int(instances.statuses[0, row])
            rewards[name] = float(instances.rewards[0, row])
            truncations[name] = status == _TIMED_OUT or (truncated and status == 0)
            terminations[name] = not truncations[name] and (status != 0 or ended)
            leaves = terminations[name] or truncations[name]
            infos[name] = {"outcome": outcome(status)} if leaves else {}
        self.agents = [name for name in self.agents if not (terminations[name] or truncations[name])]
        return observations, rewards, terminations, truncations, infos

    def _observed(self, array: NDArray[np.float32]) -> dict[str, NDArray[np.float32]]:
        lengths = self._instances.entries
        rows = ((name, self._rows[name]) for name in self.agents)
        return {name: array[0, row, : len(lengths[row])].copy() for name, row in rows}

    def close(self) -> None:
        """Ends the environment."""
        self._instances.close()

    def render(self) -> NDArray[np.uint8] | None:
        """Draws the running episode, as ``VectorEnv.render``: shape (height, width, 3); None without a `render_mode`."""
        return None if self.render_mode is None else self._instances.render(0)

    def episode(self, *, running: bool = False) -> Episode:
        """Seed and actions of the last episode that ended, or of the running one."""
        return self._instances.episode(0, running)

    def digest(self, *, running: bool = False) -> str:
        """Hash of the simulated history of the last episode that ended, or of the running one."""
        return self._instances.replay(0, running).digest

    def save_log(self, path: str | os.PathLike[str], *, running: bool = False, force: bool = False) -> Run:
        """Executes the last episode that ended, or the running one, again, and writes its log."""
        return self._instances.replay(0, running, path, force)


def _action(agent: str, action: Any) -> NDArray[np.float32]:
    """Returns the action of an agent."""
    try:
        given = np.asarray(action, dtype=np.float32)
    except (TypeError, ValueError):
        raise _arguments.refused(f"actions: {agent}", action, "two numbers") from None
    if given.shape != (2,):
        raise InvalidInput(f"actions: {agent}: shape {given.shape}: expected (2,)")
    return given


def parallel_env(
    scenario: str | os.PathLike[str] = "chase",
    *,
    agents: Sequence[str],
    observation: str = "state",
    action: str = "twist",
    seed: int | None = None,
    ticks_per_action: int = 1,
    set: Mapping[str, Any] | None = None,
    reward: Reward = None,
    planners: Mapping[str, Callable[..., Any]] | None = None,
    record: bool = True,
    allow_outside: bool = False,
    render_mode: str | None = None,
) -> ParallelEnv:
    """Makes an environment with one learner per agent, after PettingZoo's ``ParallelEnv``.

    Parameters
    ----------
    scenario, agents, observation, action, seed, ticks_per_action, set, reward, planners, record, allow_outside, render_mode
        As for ``VectorEnv``.

    Raises
    ------
    InvalidInput
        The scenario or an argument is invalid.

    Examples
    --------
    >>> import protean_robotics as pr
    >>> env = pr.parallel_env("chase_exact", agents=["evader", "police"])
    >>> observations, infos = env.reset(seed=1)
    >>> env.agents
    ['evader_1', 'evader_2', 'police_1', 'police_2', 'police_3', 'police_4']
    >>> actions = {name: env.action_space(name).sample() for name in env.agents}
    >>> observations, rewards, terminations, truncations, infos = env.step(actions)
    >>> rewards["evader_1"]
    0.0
    """
    mode = checked_mode(render_mode)
    instances = Instances(
        scenario,
        1,
        agents=agents,
        observation=observation,
        action=action,
        seed=seed,
        autoreset_mode="Disabled",
        ticks_per_action=ticks_per_action,
        threads=1,
        set=set,
        reward=reward,
        planners=planners,
        record=record,
        allow_outside=allow_outside,
    )
    return ParallelEnv(instances, mode)
