"""Runs of missions."""

import json
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ._arguments import checked
from ._core import run_in_process
from ._errors import InvalidInput
from ._log import Log
from ._planner import ONLY_IN_PROCESS, placed
from ._process import Process, declared
from ._program import json_of, overrides
from ._views import run_html

if TYPE_CHECKING:
    # Optional.
    from matplotlib.axes import Axes  # type: ignore[import-not-found, unused-ignore]


@dataclass(frozen=True, repr=False)
class Run:
    """Result of a run.

    Attributes
    ----------
    summary
        All figures, as ``protean run --json`` prints them.
    """

    summary: dict[str, Any]

    @property
    def outcome(self) -> dict[str, str]:
        """Outcome of each robot: "active", "caught", "escaped", "timed_out", "goal_reached" or "disabled"."""
        return {robot["name"]: robot["outcome"] for robot in self.summary["robots"]}

    @property
    def metrics(self) -> dict[str, dict[str, Any]]:
        """Figures of each robot: ``time_s`` (s), ``distance_m`` (m), ``contacts`` and those of its rules."""
        words = ("name", "outcome", "role", "team")
        robots = self.summary["robots"]
        return {robot["name"]: {key: value for key, value in robot.items() if key not in words} for robot in robots}

    @property
    def events(self) -> list[dict[str, Any]]:
        """Events in order, as those of ``Log.events``; the log also has those beyond the first 100 000."""
        return list(self.summary["events"])

    @property
    def digest(self) -> str:
        """Hash of the simulated history, 64 hexadecimal digits."""
        return str(self.summary["digest"])

    @property
    def seed(self) -> int:
        """Seed of the run."""
        return int(self.summary["seed"])

    @property
    def time(self) -> float:
        """Simulated time at the end (s)."""
        return float(self.summary["sim_time_s"])

    @property
    def log_path(self) -> Path | None:
        """Path of the log; None if the run has none."""
        path = self.summary["log"]
        return Path(path) if path else None

    @cached_property
    def log(self) -> Log:
        """Log of the run; an :class:`InvalidInput` if it has none (`log_path`)."""
        if self.log_path is None:
            raise InvalidInput("the run has no log: expected out=PATH")
        return Log(self.log_path)

    def branch(self, at: float, **change: Any) -> Log:
        """Goes on from a moment (s) with a change, as :meth:`Log.branch`; the run needs a log."""
        return self.log.branch(at, **change)

    def decided(self, **options: Any) -> dict[str, Any]:
        """Finds when the outcomes were decided, as :meth:`Log.decided`; the run needs a log."""
        return self.log.decided(**options)

    def plot(self, *, ax: "Axes | None" = None) -> "Axes":
        """Draws the paths of the robots on the map into axes of matplotlib, as ``Log.plot``.

        Parameters
        ----------
        ax
            Axes; new ones if None.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        ImportError
            matplotlib is not installed.
        InvalidInput
            The run has no log.
        """
        return self.log.plot(ax=ax)

    def _repr_html_(self) -> str:
        """Returns the animated report for a notebook; of a run without a log its outcome."""
        return self.log._repr_html_() if self.log_path else run_html(self)

    def __repr__(self) -> str:
        outcomes = ", ".join(f"{name} {outcome}" for name, outcome in self.outcome.items())
        return f"<Run {self.summary['scenario']}, seed {self.seed}: {outcomes}; digest {self.digest[:12]}…>"


@checked
def run(
    scenario: str | os.PathLike[str] = "chase",
    *,
    seed: int | None = None,
    set: Mapping[str, Any] | None = None,
    in_process: bool = False,
    planners: Mapping[str, Callable[..., Any]] | None = None,
    processes: Mapping[str, Process] | None = None,
    out: str | os.PathLike[str] | None = None,
    force: bool = False,
    allow_external: bool = False,
    allow_outside: bool = False,
) -> Run:
    """Runs a mission to its end.

    Parameters
    ----------
    scenario
        Name of a built-in scenario, or path of a scenario file.
    seed
        Seed of all random numbers; the scenario's if None.
    set
        Values that replace those of the scenario, by their dotted keys.
    in_process
        True to run all processes in one thread of this one: the same digest, no latencies, no log unless `out` is
        given. Otherwise they are processes of the operating system.
    planners
        Planners, also as mere functions or classes, in the place of those of the scenario, by the name of a robot, a team or
        a process; with `in_process` only.
    processes
        Processes with own topics in the place of the scenario's programs, by the name of the process; with `in_process` only.
    out
        Path of the log; ``logs/SCENARIO-SEED.mcap`` if None.
    force
        True to overwrite an existing log.
    allow_external
        True if the scenario may start programs (``command``). Check them first.
    allow_outside
        True if the scenario may use files outside its folder.

    Returns
    -------
    Run
        Outcomes, digest, log.

    Raises
    ------
    InvalidInput
        The scenario or an argument is invalid; nothing has been started.
    Error
        The run failed.
    KeyboardInterrupt
        After Ctrl-C; the log is complete up to there.

    Examples
    --------
    >>> import protean_robotics as pr
    >>> run = pr.run("chase", seed=7, set={"rules.time_limit": 2}, in_process=True)
    >>> run.outcome["evader_1"]
    'timed_out'
    >>> run.digest == pr.run("chase", seed=7, set={"rules.time_limit": 2}, in_process=True).digest
    True
    """
    changes = overrides(set)
    if in_process:
        changes += declared(processes)
        report = run_in_process(
            os.fspath(scenario),
            seed=seed,
            overrides=changes,
            out=out,
            force=force,
            allow_outside=allow_outside,
            planners=placed({**(planners or {}), **(processes or {})}),
        )
        return Run(json.loads(report))
    if planners or processes:
        raise InvalidInput(ONLY_IN_PROCESS)
    command = ["run", os.fspath(scenario), "--quiet", *(f"--set={change}" for change in changes)]
    if seed is not None:
        command.append(f"--seed={seed}")
    if out is not None:
        command.append(f"--out={os.fspath(out)}")
    flags = {"--force": force, "--allow-external": allow_external, "--allow-outside": allow_outside}
    return Run(json_of(command + [flag for flag, given in flags.items() if given]))
