"""Environments of stable-baselines3."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv as _VecEnv  # type: ignore[import-not-found, unused-ignore]

from . import _arguments
from ._errors import InvalidInput
from ._gymnasium import VectorEnv

_Indices = None | int | Iterable[int]


class VecEnv(_VecEnv):  # type: ignore[misc, unused-ignore]
    """A ``VectorEnv`` as stable-baselines3's ``VecEnv``, with the results of its ``DummyVecEnv`` of as many ``Env``.

    All instances step in one call. The next episode begins in the step that ends one, with "terminal_observation" and
    "TimeLimit.truncated" in the information of the instance, and what ``Env.step`` returns: "return", "length" and
    "outcome". ``VecMonitor`` and ``VecNormalize`` go around it.

    ``seed`` and ``set_options`` have their effect in the next ``reset``; options are those of ``Env.reset``, one mapping
    for all instances or a list of one for each.

    Parameters
    ----------
    envs
        The environments, with the default ``autoreset_mode``.

    Raises
    ------
    InvalidInput
        It is no ``VectorEnv``, or has another ``autoreset_mode``.

    Examples
    --------
    >>> import protean_robotics as pr
    >>> envs = pr.VectorEnv("hello", 8, agents=["robot"], observation="state+path", ticks_per_action=10)
    >>> # model = PPO("MlpPolicy", VecMonitor(pr.sb3.VecEnv(envs)))
    """

    def __init__(self, envs: VectorEnv) -> None:
        if not isinstance(envs, VectorEnv) or envs.autoreset_mode is not AutoresetMode.SAME_STEP:
            raise _arguments.refused("envs", envs, "a VectorEnv with autoreset_mode SAME_STEP")
        self.envs = envs
        self._actions: NDArray[np.float32] | None = None
        super().__init__(envs.num_envs, envs.single_observation_space, envs.single_action_space)

    def reset(self) -> NDArray[np.float32]:
        """Begins new episodes.

        Returns
        -------
        NDArray
            First observations, shape (num_envs, ...).
        """
        seeds = None if all(seed is None for seed in self._seeds) else self._seeds
        observations, infos = self.envs.reset(seed=seeds, options=self._joined_options())
        self._reset_seeds()
        self._reset_options()
        self._begin(infos)
        return np.array(observations)

    def _joined_options(self) -> dict[str, Any]:
        """Returns the options of all instances as one."""
        for options in self._options:
            for name in _arguments.mapping("options", options):
                if name != "set":
                    raise InvalidInput(f"options: no option {name!r}: expected set")
        each = [options.get("set") for options in self._options]
        return {} if all(own is None for own in each) else {"set": each}

    def _begin(self, infos: dict[str, Any]) -> None:
        for i in np.flatnonzero(infos["_seed"]).tolist():
            self.reset_infos[i] = {"seed": int(infos["seed"][i])}

    def step_async(self, actions: NDArray[np.float32]) -> None:
        """Takes the actions of a step.

        Parameters
        ----------
        actions
            Actions, shape (num_envs, ...).
        """
        self._actions = actions

    def step_wait(self) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Does the step.

        Returns
        -------
        observations
            Observations; where the step ended an episode, the first one of the next.
        rewards
            Rewards.
        dones
            True where the step ended an episode.
        infos
            Information of each instance.
        """
        if self._actions is None:
            raise InvalidInput("step_wait: no actions: expected step_async before it")
        observations, rewards, terminations, truncations, results = self.envs.step(self._actions)
        self._actions = None
        cut = truncations & ~terminations
        infos: list[dict[str, Any]] = [{"TimeLimit.truncated": own} for own in cut.tolist()]
        if "final_obs" in results:
            for i in np.flatnonzero(results["_final_obs"]).tolist():
                infos[i] |= {
                    "return": float(results["return"][i]),
                    "length": int(results["length"][i]),
                    "outcome": results["outcome"][i],
                    "terminal_observation": results["final_obs"][i],
                }
            self._begin(results)
        return np.array(observations), rewards.astype(np.float32), terminations | truncations, infos

    def get_images(self) -> list[NDArray[np.uint8] | None]:
        """Draws the running episodes, as ``VectorEnv.render``; each None without a `render_mode`."""
        return self.env_method("render")

    def close(self) -> None:
        """Closes the environments."""
        self.envs.close()

    def get_attr(self, attr_name: str, indices: _Indices = None) -> list[Any]:
        """Returns an attribute of instances.

        Parameters
        ----------
        attr_name
            As of ``VectorEnv.call``.
        indices
            Indices of the instances; None for all.
        """
        return self.envs._call(attr_name, self._get_indices(indices), (), {})

    def set_attr(self, attr_name: str, value: Any, indices: _Indices = None) -> None:
        """Refuses: instances have no attributes of their own; ``set_options`` changes their scenario.

        Parameters
        ----------
        attr_name, value, indices
            As stable-baselines3 gives them.
        """
        raise InvalidInput(f"set_attr: {attr_name!r}: no attribute to set: expected set_options({{'set': …}})")

    def env_method(self, method_name: str, *method_args: Any, indices: _Indices = None, **method_kwargs: Any) -> list[Any]:
        """Calls a method for each of some instances.

        Parameters
        ----------
        method_name
            "digest", "episode", "render" or "save_log".
        *method_args, **method_kwargs
            Its arguments, without the index of the instance.
        indices
            Indices of the instances; None for all.
        """
        return self.envs._call(method_name, self._get_indices(indices), method_args, method_kwargs)

    def env_is_wrapped(self, wrapper_class: type[Any], indices: _Indices = None) -> list[bool]:
        """Returns False for each of some instances: none is wrapped by itself.

        Parameters
        ----------
        wrapper_class
            Class of wrappers.
        indices
            Indices of the instances; None for all.
        """
        return [False for _ in self._get_indices(indices)]
