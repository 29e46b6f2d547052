"""Patrols along a contour."""

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

from . import _core
from ._arguments import checked, index, number
from ._program import overrides

ZigZag = _core.patrol.ZigZag


@checked
def plan(
    scenario: str | os.PathLike[str] = "patrol_octagon",
    *,
    process: str | None = None,
    key: str | None = None,
    laps: int = 1,
    seed: int | None = None,
    set: Mapping[str, Any] | None = None,
    allow_outside: bool = False,
) -> dict[str, Any]:
    """Plans the first laps of the patrol of a scenario, without a run.

    Parameters
    ----------
    scenario
        Name of a built-in scenario, or path of a scenario file.
    process
        Name of the process; required if several patrol.
    key
        Generator and state; the scenario's if None.
    laps
        Number of laps, at most 10 000.
    seed
        Seed of the run; the scenario's if None.
    set
        Values that replace those of the scenario, by their dotted keys.
    allow_outside
        True if the scenario may use files outside its folder.

    Returns
    -------
    dict
        Process, robot, key, width of the zig-zag (`alpha`) and its origin, `waypoints`, `metrics`, `warnings`.

    Raises
    ------
    InvalidInput
        A scenario without a patrol, or with several; laps that the generator cannot reach.

    Examples
    --------
    >>> import protean_robotics as pr
    >>> laps = pr.patrol.plan("patrol_octagon", laps=2)
    >>> laps["metrics"]["laps"], len(laps["waypoints"]) - 1 == 2 * laps["waypoints_per_lap"]
    (2, True)
    """
    source = (os.fspath(scenario), overrides(set), seed, allow_outside, process)
    found: dict[str, Any] = json.loads(_core.plan_patrol(source, key, laps))
    return found


@checked
def predict(
    scenario: str | os.PathLike[str] = "patrol_octagon",
    *,
    times: Sequence[float] = (),
    waypoints: Sequence[int] = (),
    process: str | None = None,
    key: str | None = None,
    seed: int | None = None,
    set: Mapping[str, Any] | None = None,
    allow_outside: bool = False,
) -> dict[str, Any]:
    """Predicts the patrol of a scenario from its key, without a run.

    Waypoints are exact at any distance in the future. Times follow the schedule of the waypoints, which starts when the
    robot leaves the start of the contour. A robot with `pace = "clock"` follows it within the limits of its drive and of
    obstacles: after a long leg it is late and catches up.

    Parameters
    ----------
    scenario
        Name of a built-in scenario, or path of a scenario file.
    times
        Times since the robot left the start of the contour (s).
    waypoints
        Numbers of waypoints; 0 is the start.
    process
        Name of the process; required if several patrol.
    key
        Generator and state; the scenario's if None.
    seed
        Seed of the run; the scenario's if None.
    set
        Values that replace those of the scenario, by their dotted keys.
    allow_outside
        True if the scenario may use files outside its folder.

    Returns
    -------
    dict
        As of :func:`plan`, with a position for every time (`at`) and the `waypoints` with these numbers.

    Raises
    ------
    InvalidInput
        A scenario without a patrol, or with several; a time or number that is invalid or too far ahead.

    Examples
    --------
    >>> import protean_robotics as pr
    >>> found = pr.patrol.predict("patrol_octagon", times=[300], waypoints=[100])
    >>> found["at"][0]["t"], found["waypoints"][0]["number"]
    (300.0, 100)
    """
    source = (os.fspath(scenario), overrides(set), seed, allow_outside, process)
    seconds = [number("times", time) for time in times]
    numbers = [index("waypoints", waypoint) for waypoint in waypoints]
    found: dict[str, Any] = json.loads(_core.predict_patrol(source, key, seconds, numbers))
    return found


__all__ = ["ZigZag", "plan", "predict"]
