"""Runs of missions."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from ._core import Error, InvalidInput, run_in_process
from ._log import Log
from ._planner import Planner, _command
from ._program import program

#: Exit code of the command for input that is invalid; nothing has been started.
_INVALID = 2
#: Exit code of the command for a run that ended with a warning: a process failed, or messages were lost.
_PARTIAL = 3


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

    @cached_property
    def log(self) -> Log | None:
        """Log of the run; None if it has none."""
        path = self.summary["log"]
        return Log(path) if path else None

    def __repr__(self) -> str:
        outcomes = ", ".join(f"{name} {outcome}" for name, outcome in self.outcome.items())
        return f"<Run {self.summary['scenario']}, seed {self.seed}: {outcomes}; digest {self.digest[:12]}…>"


def run(
    scenario: str | os.PathLike[str] = "chase",
    *,
    seed: int | None = None,
    set: Mapping[str, Any] | None = None,
    in_process: bool = False,
    planners: Mapping[str, Planner] | None = None,
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
        Planners in the place of those of the scenario, by the name of a robot, a team or a process; with `in_process`
        only.
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
    overrides = [f"{key}={_toml(value)}" for key, value in (set or {}).items()]
    if in_process:
        placed = []
        for name, planner in (planners or {}).items():
            command, folder = _command(planner)
            placed.append(SimpleNamespace(name=name, function=planner._function, command=command, folder=folder))
        report = run_in_process(
            os.fspath(scenario),
            seed=seed,
            overrides=overrides,
            out=out,
            force=force,
            allow_outside=allow_outside,
            planners=placed,
        )
        return Run(json.loads(report))
    if planners:
        raise InvalidInput(
            "planners: expected in_process=True; a planner that is a process is a program of the scenario"
            ' (command = ["python3", "FILE"])'
        )
    command = [str(program()), "run", os.fspath(scenario), "--json", "--quiet"]
    command += [f"--set={value}" for value in overrides]
    if seed is not None:
        command.append(f"--seed={seed}")
    if out is not None:
        command.append(f"--out={os.fspath(out)}")
    flags = {"--force": force, "--allow-external": allow_external, "--allow-outside": allow_outside}
    command += [flag for flag, given in flags.items() if given]
    return Run(_output(command))


def _output(command: list[str]) -> dict[str, Any]:
    """Runs a command of `protean` and returns the JSON object that it prints."""
    # Programs of a scenario find the interpreter and packages of this process first.
    folder = str(Path(sys.executable).parent)
    environment = os.environ | {"PATH": folder + os.pathsep + os.environ.get("PATH", os.defpath)}
    # In a group of its own, so that Ctrl-C reaches it once, from here.
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment, process_group=0
    ) as process:
        try:
            output, messages = process.communicate()
        except KeyboardInterrupt:
            process.send_signal(signal.SIGINT)
            process.communicate()
            raise
    if process.returncode in (0, _PARTIAL) and output:
        if messages:
            print(messages, end="", file=sys.stderr)
        report: dict[str, Any] = json.loads(output)
        return report
    text = messages.strip().removeprefix("error: ")
    raise InvalidInput(text) if process.returncode == _INVALID else Error(text)


def _toml(value: Any) -> str:
    """Writes a value as in TOML."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{json.dumps(str(key))} = {_toml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    if hasattr(value, "tolist"):
        # Arrays and numbers of NumPy.
        return _toml(value.tolist())
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    if isinstance(value, (bool, str)):
        return json.dumps(value)
    return repr(value)
