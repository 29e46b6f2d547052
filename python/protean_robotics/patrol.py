"""Patrols along a contour."""

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arguments import checked, index, number, refused, texts
from ._log import Log
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


@checked
def detection(
    log: Log,
    *,
    duration: float,
    distance: float = 1.0,
    places: ArrayLike | None = None,
    robots: Sequence[str] | None = None,
    start: float = 0.0,
) -> dict[str, Any]:
    """Computes the share of start times at which guards detect an attack, for each place of a patrol.

    An attack at a place is detected if a guard comes within `distance` of the place while it lasts. Every state of the log
    is a start time, as long as the attack ends in the log. The minimum over the places is the probability of detection of an
    adversary that knows these shares and draws the time at random.

    Parameters
    ----------
    log
        Log of a run.
    duration
        Duration of an attack (s).
    distance
        Distance from the place at which a guard detects it (m).
    places
        Places (m), shape (n, 2); those of the patrol if None: pieces of the contour, or the nodes of the graph.
    robots
        Names of the guards; those of the patrol if None.
    start
        Simulated time from which on attacks begin (s): without the way of the guards to their places, for example.

    Returns
    -------
    dict
        `places` (m), shape (n, 2), and their `shares`, 0 to 1, shape (n,); `minimum`, the least of these, with its 95 %
        `interval` by batch means (ten blocks of consecutive start times, Student's t), and its place `worst` (m), shape
        (2,). The interval is that of a place chosen beforehand, and too narrow for blocks that are not longer than a lap.

    Raises
    ------
    InvalidInput
        A log without a patrol, or with several, and no `places` and `robots`; an unknown robot; a time too short for ten
        attacks.

    Examples
    --------
    >>> import protean_robotics as pr
    >>> run = pr.run("patrol_team", set={"rules.time_limit": 120}, seed=1, in_process=True, out="team.mcap")
    >>> found = pr.patrol.detection(pr.Log("team.mcap"), duration=20, start=40)
    >>> 0 <= found["minimum"] <= found["shares"].mean() <= 1
    True
    """
    if not isinstance(log, Log):
        raise refused("log", log, "a log (`pr.Log`)")
    if robots is not None:
        robots = texts("robots", robots)
    if places is None or robots is None:
        patrols = log._file.patrol_places()
        if len(patrols) != 1:
            name = "places" if places is None else "robots"
            raise refused(name, None, f"a value: the log has {len(patrols)} patrols")
        [(guards, pieces)] = patrols
        robots = guards if robots is None else robots
        places = pieces if places is None else places
    states = log.robots
    names, times = states["name"], states["t"]
    rows = [np.flatnonzero((names == robot) & (times >= number("start", start))) for robot in robots]
    if not rows or any(len(of) != len(rows[0]) or not len(of) for of in rows):
        raise refused("robots", robots, "names of robots with states from `start` on")
    # A robot out of play detects nothing.
    in_play = states["status"] == "active"
    guards_at = [np.where(in_play[of, None], np.stack([states["x"], states["y"]], 1)[of], 1e300) for of in rows]
    positions = np.stack(guards_at, 1).reshape(-1, 2)
    shares, intervals = _core.patrol.detection(
        times[rows[0]], positions, places, number("distance", distance), number("duration", duration)
    )
    if not len(shares):
        raise refused("places", places, "at least one place")
    at = np.asarray(places, dtype=float).reshape(-1, 2)
    least = int(np.argmin(shares))
    return {
        "places": at,
        "shares": shares,
        "minimum": float(shares[least]),
        "interval": tuple(intervals[least].tolist()),
        "worst": at[least],
    }


__all__ = ["ZigZag", "detection", "plan", "predict"]
