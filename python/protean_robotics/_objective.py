"""Objectives for searches of parameters."""

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ._arguments import checked, mapping, number
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
    runs, for comparison when it is repeated.

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
        For ``study.optimize``; with its ``n_jobs``, trials use several cores.

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
    def mean(trial: Any) -> float:
        values = {**(set or {}), **mapping("suggest", suggest(trial))}
        runs = [
            run(scenario, seed=seed, set=values, in_process=True, planners=planners, allow_outside=allow_outside)
            for seed in seeds
        ]
        trial.set_user_attr("digests", [done.digest for done in runs])
        return sum(number("value", value(done)) for done in runs) / len(runs)

    return mean
