"""Objectives for searches of parameters."""

import importlib
import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ._arguments import checked, mapping, number, refused
from ._run import Run, run


@checked
def objective(
    scenario: str | os.PathLike[str],
    suggest: Callable[[Any], Mapping[str, Any]],
    value: Callable[[Run], float],
    *,
    seeds: Sequence[int],
    set: Mapping[str, Any] | None = None,
    planners: Mapping[str, Callable[..., Any]] | None = None,
    allow_outside: bool = False,
) -> Callable[[Any], float]:
    """Returns an objective for Optuna: the mean of a value over runs of a scenario.

    Every trial has the same seeds, so that trials compare. The attribute ``digests`` of a trial has the digests of its
    runs, for comparison when it is repeated. After each run the trial reports the mean so far, by which the pruner of the
    study may end it: pass ``optuna.pruners.NopPruner()`` to the study for trials of all seeds.

    Parameters
    ----------
    scenario
        Name of a built-in scenario, or path of a scenario file.
    suggest
        Returns the values of a trial, by their dotted keys.
    value
        Value of a run; NaN or infinity is an error.
    seeds
        Seeds of the runs of each trial, at least one.
    set
        Values that all trials share, by their dotted keys.
    planners
        Planners in the place of those of the scenario, as for :func:`run`.
    allow_outside
        True if the scenario may use files outside its folder.

    Returns
    -------
    Callable
        For ``study.optimize``; with its ``n_jobs``, trials use several cores. It raises ``optuna.TrialPruned`` in a trial
        that the pruner ends.

    Raises
    ------
    InvalidInput
        An argument is invalid.

    Examples
    --------
    >>> from typing import Any
    >>> import protean_robotics as pr
    >>> def suggest(trial: Any) -> dict[str, float]:
    ...     return {"teams.evader.limits.v_max": trial.suggest_float("v_max", 0.1, 0.5)}
    >>> def escapes(run: pr.Run) -> int:
    ...     return sum(outcome == "escaped" for outcome in run.outcome.values())
    >>> objective = pr.objective("chase", suggest, escapes, seeds=range(1, 9))
    >>> # optuna.create_study(direction="maximize").optimize(objective, n_trials=50)
    """
    options = {"planners": planners, "allow_outside": allow_outside}
    return _Objective(scenario, suggest, value, list(seeds), dict(set or {}), options)


@dataclass(frozen=True)
class _Objective:
    """A search's objective; workers of a cluster get it pickled."""

    scenario: str | os.PathLike[str]
    suggest: Callable[[Any], Mapping[str, Any]]
    value: Callable[[Run], float]
    seeds: list[int]
    set: dict[str, Any]
    options: dict[str, Any]

    def __call__(self, trial: Any) -> float:
        values = {**self.set, **mapping("suggest", self.suggest(trial))}
        digests: list[str] = []
        total = 0.0
        for count, seed in enumerate(self.seeds, start=1):
            done = run(self.scenario, seed=seed, set=values, in_process=True, **self.options)
            digests.append(done.digest)
            value = number("value", self.value(done))
            if not math.isfinite(value):
                raise refused("value", value, "a finite number")
            total += value
            trial.set_user_attr("digests", digests)
            trial.report(total / count, count)
            if count < len(self.seeds) and trial.should_prune():
                raise importlib.import_module("optuna").TrialPruned(f"after {count} of {len(self.seeds)} seeds")
        return total / len(self.seeds)
