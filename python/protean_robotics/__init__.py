"""Missions of mobile robots: run them, read their logs, write planners.

>>> import protean_robotics as pr
>>> pr.run("hello", in_process=True, seed=1).outcome
{'robot': 'escaped'}
"""

import importlib
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from . import coverage, executors, navigation, patrol, rrt_star, steering, tracking, trajectory
from ._core import (
    Belief,
    Map,
    Steering,
    Robot,
    Scan,
    World,
    __version__,
    go_to,
)
from ._environments import Episode, Step
from ._errors import Error, InvalidInput, MissingFile
from ._log import Log, Topic
from ._objective import objective
from ._pickling import register as _register
from ._planner import Planner, planner, serve
from ._process import Message, Output, Process, process
from ._program import program
from ._run import Run, run
from ._sweep import Executor, Future, Sweep, sweep
from ._table import Table

_register()
try:
    from . import _registration as _registration
except ModuleNotFoundError as _error:
    if _error.name != "gymnasium":
        raise

if TYPE_CHECKING:
    from ._gymnasium import Env as Env
    from ._gymnasium import VectorEnv as VectorEnv
    from ._pettingzoo import ParallelEnv as ParallelEnv
    from ._pettingzoo import parallel_env as parallel_env
    from . import sb3 as sb3

__all__ = [
    "Belief",
    "Episode",
    "Error",
    "Executor",
    "Future",
    "InvalidInput",
    "Log",
    "Map",
    "Message",
    "MissingFile",
    "Output",
    "Planner",
    "Process",
    "Robot",
    "Run",
    "Scan",
    "Steering",
    "Step",
    "Sweep",
    "Table",
    "Topic",
    "World",
    "__version__",
    "coverage",
    "executors",
    "go_to",
    "navigation",
    "objective",
    "patrol",
    "planner",
    "process",
    "program",
    "rrt_star",
    "run",
    "serve",
    "steering",
    "sweep",
    "tracking",
    "trajectory",
]

# Without their packages, `from protean_robotics import *` leaves them out.
if find_spec("gymnasium") and find_spec("pettingzoo"):
    __all__ += ["Env", "ParallelEnv", "VectorEnv", "parallel_env"]

#: Modules of the names that need the packages of the extra `gym`.
_GYM = {
    "Env": "_gymnasium",
    "VectorEnv": "_gymnasium",
    "ParallelEnv": "_pettingzoo",
    "parallel_env": "_pettingzoo",
}


def __getattr__(name: str) -> Any:
    if name not in _GYM and name != "sb3":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    extra = "gym" if name in _GYM else "sb3"
    try:
        module = importlib.import_module(f".{_GYM.get(name, name)}", __name__)
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(f"{name}: {error}: expected pip install 'protean-robotics[{extra}]'") from error
    return module if name == "sb3" else getattr(module, name)


def __dir__() -> list[str]:
    return sorted({*__all__, *_GYM, "sb3"})
