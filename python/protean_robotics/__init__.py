"""Missions of mobile robots: run them, read their logs, write planners.

>>> import protean_robotics as pr
>>> pr.run("hello", in_process=True, seed=1).outcome
{'robot': 'escaped'}
"""

from . import coverage, executors, navigation, patrol, rrt_star, steering, tracking, trajectory
from ._core import (
    Belief,
    Error,
    InvalidInput,
    Map,
    Steering,
    Robot,
    Scan,
    World,
    __version__,
    go_to,
)
from ._log import Log, Topic
from ._objective import objective
from ._planner import Planner, planner, serve
from ._program import program
from ._run import Run, run
from ._sweep import Executor, Future, Sweep, sweep

__all__ = [
    "Belief",
    "Error",
    "Executor",
    "Future",
    "InvalidInput",
    "Log",
    "Map",
    "Planner",
    "Robot",
    "Run",
    "Scan",
    "Steering",
    "Sweep",
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
    "program",
    "rrt_star",
    "run",
    "serve",
    "steering",
    "sweep",
    "tracking",
    "trajectory",
]
