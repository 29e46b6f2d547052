"""Environments of stable-baselines3, which the extra ``sb3`` installs."""

from typing import TYPE_CHECKING, Any

from ._gymnasium import VectorEnv

if TYPE_CHECKING:
    # Types must be complete also where the library, whose class it extends, is absent.
    def VecEnv(envs: VectorEnv) -> Any:
        """A ``VectorEnv`` as stable-baselines3's ``VecEnv``."""

else:
    from ._sb3 import VecEnv

__all__ = ["VecEnv"]
