"""Environments of Gymnasium."""

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Space
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from . import _arguments
from ._environments import Episode, Instances, Reward, described, outcome, render_mode as checked_mode
from ._pickling import remade
from ._run import Run


def box(shape: tuple[int, ...]) -> Space[NDArray[np.float32]]:
    """Returns the space of arrays whose entries are in -1..1."""
    return Box(-1.0, 1.0, shape, np.float32)


@remade
class VectorEnv(gymnasium.vector.VectorEnv[NDArray[np.float32], NDArray[np.float32], NDArray[Any]]):
    """Instances of a scenario in which a learner steers the agents, after Gymnasium's ``VectorEnv``.

    The scenario's own processes drive all other robots: perception with its beliefs, planners. An action of an agent is
    two numbers in -1..1: by default the shares of its maximum forward speed and turning rate. An episode ends with the mission, or
    when no agent is in the game; the time limit of the rules truncates it.

    By default the next episode begins in the same step (``AutoresetMode.SAME_STEP``): the last observation of an ended one
    is ``infos["final_obs"][i]``, its information is in ``infos["final_info"]``.

    With several agents, observations have the shape (num_envs, agents, entries), actions (num_envs, agents, 2), and
    the reward is the sum over the agents; ``infos["rewards"]`` has the single ones.

    Parameters
    ----------
    scenario
        Name of a built-in scenario, or path of a scenario file.
    num_envs
        Number of instances, at most 65 536; their observations have at most 2^26 numbers in all.
    agents
        Names of the robots, teams or processes that the learner steers.
    observation
        Contents of the observations: "state" (true poses of all robots, lines of sight), "scan" (own range scan),
        "belief" (beliefs about opponents), "path" (shortest paths to exits and opponents), "potential" (action of
        `evader_potential`), or several as in "state+path".
        Attribute `entries` has the names of all entries.
    action
        Meaning of the actions: "twist" (forward speed and turning rate) or, for evaders, "tune" (parameters of an
        "evader_potential" that steers in every tick) or "residual" (what is added to its action).
    seed
        Seed of all episodes, if `reset` gives none; another one for each environment if None. The seeds of episodes follow
        from it, from the index of the instance and from the number of the episode.
    autoreset_mode
        ``AutoresetMode.NEXT_STEP`` or "NextStep": the next step begins the next episode, whatever its action;
        ``SAME_STEP``; ``DISABLED``: `reset` must begin it.
    ticks_per_action
        Number of ticks of a step: the action holds, rewards add up, and the observation is that after the last tick. As
        the parameter of the kind "policy".
    threads
        Number of threads; results do not depend on it.
    set
        Values that replace those of the scenario, by their dotted keys.
    reward
        Weights of the events: "escape" (default 1), "caught" (-1), "capture" (1; an opponent was caught), "lost" (-1; an
        opponent escaped), "arrival" (1; at the goal), "contact" (0); "time" (0; per second), "progress" (0; per metre by
        which the way to the goal, or to the nearest exit, became shorter). Or a function from a ``Step`` to rewards.
    planners
        Planners in the place of those of the scenario, as for ``run``.
    record
        False to keep no actions, 8 B for each agent and tick of the running and of the last episode: ``episode``, ``digest``
        and ``save_log`` are then refused.
    copy
        False to return the arrays themselves, which the next step overwrites.
    allow_outside
        True if the scenario may use files outside its folder.
    render_mode
        "rgb_array" for `render`; None for none.

    Raises
    ------
    InvalidInput
        The scenario or an argument is invalid.

    Examples
    --------
    >>> import protean_robotics as pr
    >>> envs = pr.VectorEnv("chase_exact", 3, agents=["evader_1"], seed=1, set={"rules.time_limit": 1})
    >>> observations, infos = envs.reset()
    >>> observations.shape, envs.seeds.shape
    ((3, 62), (3,))
    >>> for _ in range(20):
    ...     observations, rewards, terminations, truncations, infos = envs.step(envs.action_space.sample())
    >>> infos["length"].tolist()
    [20, 20, 20]
    >>> len(envs.digest(0))
    64
    """

    metadata: dict[str, Any]
    render_mode: str | None
    num_envs: int
    #: Until the constructor is done.
    closed: bool = True
    autoreset_mode: AutoresetMode
    single_observation_space: Space[NDArray[np.float32]]
    single_action_space: Space[NDArray[np.float32]]
    observation_space: Space[NDArray[np.float32]]
    action_space: Space[NDArray[np.float32]]

    def __init__(
        self,
        scenario: str | os.PathLike[str] = "chase",
        num_envs: int = 1,
        *,
        agents: Sequence[str],
        observation: str = "state",
        action: str = "twist",
        seed: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
        ticks_per_action: int = 1,
        threads: int = 1,
        set: Mapping[str, Any] | None = None,
        reward: Reward = None,
        planners: Mapping[str, Callable[..., Any]] | None = None,
        record: bool = True,
        copy: bool = True,
        allow_outside: bool = False,
        render_mode: str | None = None,
    ) -> None:
        try:
            # TorchRL reads the attribute, Gymnasium the metadata.
            self.autoreset_mode = AutoresetMode(autoreset_mode)
        except ValueError:
            expected = ", ".join(mode.value for mode in AutoresetMode)
            raise _arguments.refused("autoreset_mode", autoreset_mode, expected) from None
        self._copy = _arguments.flag("copy", copy)
        self.render_mode = checked_mode(render_mode)
        self._instances = instances = Instances(
            scenario,
            num_envs,
            agents=agents,
            observation=observation,
            action=action,
            seed=seed,
            autoreset_mode=self.autoreset_mode.value,
            ticks_per_action=ticks_per_action,
            threads=threads,
            set=set,
            reward=reward,
            planners=planners,
            record=record,
            allow_outside=allow_outside,
        )
        self.num_envs = instances.shape[0]
        self.metadata = instances.metadata(autoreset_mode=self.autoreset_mode)
        self._single = len(instances.agents) == 1
        entries = instances.observations.shape[2]
        count = len(instances.agents)
        self.single_observation_space = box((entries,) if self._single else (count, entries))
        self.single_action_space = box((2,) if self._single else (count, 2))
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        # With one agent, arrays without its dimension: views of the same memory.
        self._observations = instances.observations[:, 0] if self._single else instances.observations
        self._finals = instances.final_observations[:, 0] if self._single else instances.final_observations
        self.closed = False

    def __repr__(self) -> str:
        instances = self._instances
        return described("VectorEnv", instances.scenario, num_envs=self.num_envs, agents=[*self.agents])

    @property
    def agents(self) -> tuple[str, ...]:
        """Names of the agents, in the order of the arrays."""
        return self._instances.agents

    @property
    def entries(self) -> list[list[str]]:
        """Names of the entries of the observation of each agent; further entries are 0."""
        return self._instances.entries

    @property
    def seeds(self) -> NDArray[np.uint64]:
        """Seeds of the scenarios of the running episodes, shape (num_envs,)."""
        return self._instances.seeds.copy()

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins new episodes.

        Parameters
        ----------
        seed
            Seed of all episodes from now on, or one for each instance; None for the next episodes.
        options
            ``{"reset_mask": mask}`` begins episodes only in the instances where the mask is True, shape (num_envs,).
            ``{"set": {"teams.evader.limits.v_max": 0.5}}`` gives these and all following episodes other values of the
            scenario, in addition to the parameter ``set``, until another reset gives some; a list has a mapping (or
            None: as before) for each instance. Agents and observations must stay the same.

        Returns
        -------
        observations
            First observations; of instances that are not reset, the present ones.
        infos
            Seeds of the scenarios of the episodes ("seed"), with the mask "_seed" of those that begin.
        """
        self._instances.reset(seed, options, known=("reset_mask", "set"))
        if isinstance(seed, int):
            super().reset(seed=seed)
        infos: dict[str, Any] = {}
        self._add_begun(infos)
        return self._own(self._observations), infos

    def step(
        self, actions: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Does a step in all instances.

        Parameters
        ----------
        actions
            Actions of the agents, clamped to -1..1.

        Returns
        -------
        observations
            Observations; where the step began an episode, its first one.
        rewards
            Rewards, shape (num_envs,).
        terminations
            True where the rules ended the episode.
        truncations
            True where the time limit ended it.
        infos
            If an episode ended: "return", "length" (ticks) and "outcome" of the agents; with ``SAME_STEP`` also "final_obs"
            and the former in "final_info". In every step "seed", where one began. Each with its mask "_…".
        """
        return self._step(actions, self.action_space.shape, "actions")

    def _step(
        self, actions: NDArray[np.float32], shape: tuple[int, ...] | None, name: str
    ) -> tuple[NDArray[np.float32], NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        instances = self._instances
        any_ended = instances.step(actions, shape, name)
        infos: dict[str, Any] = {}
        own = self._own
        if not self._single:
            infos["rewards"] = own(instances.rewards)
            infos["_rewards"] = np.ones(self.num_envs, dtype=np.bool_)
        if any_ended:
            self._add_ended(infos)
        # In every step: TorchRL expects the entries that a reset has.
        self._add_begun(infos)
        rewards = own(instances.reward_sums)
        return own(self._observations), rewards, own(instances.terminated), own(instances.truncated), infos

    def _add_begun(self, infos: dict[str, Any]) -> None:
        begun = self._instances.begun
        infos["seed"] = np.where(begun, self._instances.seeds, 0).astype(np.int64)
        infos["_seed"] = begun.copy()

    def _add_ended(self, infos: dict[str, Any]) -> None:
        instances = self._instances
        ended = instances.ended
        rows = np.flatnonzero(ended)
        outcomes: NDArray[Any] = np.full(self.num_envs, None, dtype=object)
        for i in rows:
            outcomes[i] = [outcome(status) for status in instances.statuses[i]]
        final = {
            "return": np.where(ended, instances.returns.sum(axis=1), 0.0),
            "length": np.where(ended, instances.lengths, 0).astype(np.int64),
            "outcome": outcomes,
        }
        final |= {f"_{name}": ended.copy() for name in final}
        infos |= final
        if self.autoreset_mode is AutoresetMode.SAME_STEP:
            finals: NDArray[Any] = np.full(self.num_envs, None, dtype=object)
            for i in rows:
                finals[i] = self._finals[i].copy()
            infos |= {"final_obs": finals, "_final_obs": ended.copy(), "final_info": final, "_final_info": ended.copy()}

    def _own(self, array: NDArray[Any]) -> NDArray[Any]:
        return array.copy() if self._copy else array

    def close_extras(self, **kwargs: Any) -> None:
        """Ends the threads; called by ``close``.

        Parameters
        ----------
        **kwargs
            Ignored, as by Gymnasium's own vectors.
        """
        self._instances.close()

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Calls a method for each instance, or returns an attribute of each, as Gymnasium's own vectors.

        Parameters
        ----------
        name
            "digest", "episode", "render" or "save_log"; or "action_space", "agents", "entries", "metadata", "observation_space",
            "render_mode" or "spec".
        *args, **kwargs
            Arguments of the method, without the index of the instance.
        """
        return tuple(self._call(name, range(self.num_envs), args, kwargs))

    def _call(self, name: str, indices: Iterable[int], args: tuple[Any, ...], kwargs: dict[str, Any]) -> list[Any]:
        if name == "render":
            return [self._render(i) for i in indices]
        if name in ("digest", "episode", "save_log"):
            method = getattr(self, name)
            return [method(i, *args, **kwargs) for i in indices]
        if name in ("action_space", "observation_space"):
            name = f"single_{name}"
        elif name not in ("agents", "entries", "metadata", "render_mode", "spec"):
            raise AttributeError(f"an instance of {self!r} has no attribute {name!r} that can be called or read")
        value = getattr(self, name)
        return [value for _ in indices]

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Returns an attribute of each instance, as Gymnasium's own vectors.

        Parameters
        ----------
        name
            As of ``call``.
        """
        return self.call(name)

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Draws the running episodes as pictures of one size: robots, their paths since the first picture, obstacles.

        Returns
        -------
        tuple of numpy.ndarray, shape (height, width, 3)
            Red, green and blue of each instance, 0 to 255; None without a `render_mode`.
        """
        return None if self.render_mode is None else self.call("render")

    def _render(self, i: int) -> NDArray[np.uint8] | None:
        return None if self.render_mode is None else self._instances.render(i)

    def episode(self, i: int, *, running: bool = False) -> Episode:
        """Seed and actions of an episode of an instance.

        Parameters
        ----------
        i
            Index of the instance.
        running
            True for the running episode; otherwise the last one that ended.
        """
        return self._instances.episode(i, running)

    def digest(self, i: int, *, running: bool = False) -> str:
        """Hash of the simulated history of an episode: that of a run whose planners send the same commands.

        Parameters
        ----------
        i
            Index of the instance.
        running
            True for the running episode; otherwise the last one that ended.
        """
        return self._instances.replay(i, running).digest

    def save_log(
        self, i: int, path: str | os.PathLike[str], *, running: bool = False, force: bool = False
    ) -> Run:
        """Executes an episode of an instance again, and writes its log.

        Parameters
        ----------
        i
            Index of the instance.
        path
            Path of the log.
        running
            True for the running episode; otherwise the last one that ended.
        force
            True to overwrite an existing log.
        """
        return self._instances.replay(i, running, path, force)


@remade
class Env(gymnasium.Env[NDArray[np.float32], NDArray[np.float32]]):
    """One instance of a scenario in which a learner steers the agents, after Gymnasium's ``Env``.

    As ``VectorEnv`` with one instance, whose parameters it has; `reset` begins the next episode.

    Examples
    --------
    >>> import protean_robotics as pr
    >>> env = pr.Env("hello", agents=["robot"])
    >>> observation, info = env.reset(seed=1)
    >>> observation.shape, env.entries[0][:3]
    ((12,), ['own.active', 'own.x', 'own.y'])
    """

    metadata: dict[str, Any]
    render_mode: str | None
    observation_space: Space[NDArray[np.float32]]
    action_space: Space[NDArray[np.float32]]

    def __init__(
        self,
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
    ) -> None:
        self._vector = vector = VectorEnv(
            scenario,
            1,
            agents=agents,
            observation=observation,
            action=action,
            seed=seed,
            autoreset_mode=AutoresetMode.DISABLED,
            ticks_per_action=ticks_per_action,
            set=set,
            reward=reward,
            planners=planners,
            record=record,
            copy=False,
            allow_outside=allow_outside,
            render_mode=render_mode,
        )
        self.metadata = vector._instances.metadata()
        self.render_mode = vector.render_mode
        self.observation_space = vector.single_observation_space
        self.action_space = vector.single_action_space

    def __repr__(self) -> str:
        return described("Env", self._vector._instances.scenario, agents=[*self.agents])

    def __str__(self) -> str:
        return f"<{self!r}>"

    @property
    def agents(self) -> tuple[str, ...]:
        """Names of the agents, in the order of the arrays."""
        return self._vector.agents

    @property
    def entries(self) -> list[list[str]]:
        """Names of the entries of the observation of each agent; further entries are 0."""
        return self._vector.entries

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
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
        observation
            First observation.
        info
            The seed of the scenario of the episode ("seed").
        """
        seed = None if seed is None else _arguments.seed("seed", seed)
        instances = self._vector._instances
        instances.reset(seed, options)
        super().reset(seed=seed)
        return self._vector._observations[0].copy(), {"seed": int(instances.seeds[0])}

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Does a step.

        Parameters
        ----------
        action
            Action of the agents, clamped to -1..1.

        Returns
        -------
        observation
            Observation after the step.
        reward
            Reward.
        terminated
            True if the rules ended the episode.
        truncated
            True if the time limit ended it.
        info
            At the end: "return", "length" (ticks) and "outcome" of the agents.
        """
        vector = self._vector
        observations, rewards, terminations, truncations, infos = vector._step(action, self.action_space.shape, "action")
        info: dict[str, Any] = {}
        if "outcome" in infos:
            info = {
                "return": float(infos["return"][0]),
                "length": int(infos["length"][0]),
                "outcome": infos["outcome"][0],
            }
        return observations[0].copy(), float(rewards[0]), bool(terminations[0]), bool(truncations[0]), info

    def close(self) -> None:
        """Ends the environment."""
        self._vector.close()

    def render(self) -> NDArray[np.uint8] | None:  # type: ignore[override, unused-ignore]
        """Draws the running episode, as ``VectorEnv.render``: shape (height, width, 3); None without a `render_mode`."""
        return self._vector._render(0)

    def episode(self, *, running: bool = False) -> Episode:
        """Seed and actions of the last episode that ended, or of the running one."""
        return self._vector.episode(0, running=running)

    def digest(self, *, running: bool = False) -> str:
        """Hash of the simulated history of the last episode that ended, or of the running one."""
        return self._vector.digest(0, running=running)

    def save_log(self, path: str | os.PathLike[str], *, running: bool = False, force: bool = False) -> Run:
        """Executes the last episode that ended, or the running one, again, and writes its log."""
        return self._vector.save_log(0, path, running=running, force=force)
