"""Other futures of a recorded run."""

from collections.abc import Mapping, Sequence
from typing import Any

from ._arguments import refused
from ._program import json_of, overrides


def arguments(
    set: Mapping[str, Any] | None,
    draw: Mapping[str, Any] | None,
    replace: Mapping[str, Any] | None,
    command: Mapping[str, Any] | None,
    place: Mapping[str, Any] | None,
    duration: float | None,
    reseed: Sequence[str] | None,
    allow_external: bool,
) -> list[str]:
    """The options of a change, as `protean branch` takes them."""
    given = [f"--set={change}" for change in overrides(set)]
    given += [f"--draw={key}={_range(key, bounds)}" for key, bounds in (draw or {}).items()]
    given += [f"--replace={process}={_kind(process, kind)}" for process, kind in (replace or {}).items()]
    given += [f"--command={robot}={_twist(robot, twist)}" for robot, twist in (command or {}).items()]
    given += [f"--place={robot}={_place(robot, pose)}" for robot, pose in (place or {}).items()]
    given += [f"--reseed={process}" for process in reseed or ()]
    if duration is not None:
        given.append(f"--for={duration!r}")
    return given + ["--allow-external"] * allow_external


def _range(key: str, bounds: Any) -> str:
    try:
        low, high = (number if isinstance(number, int) else float(number) for number in bounds)
    except (TypeError, ValueError, OverflowError):
        raise refused(f"draw: {key}", bounds, "the least and the greatest value") from None
    return f"{low!r}..{high!r}"


def _kind(process: str, kind: Any) -> str:
    if not isinstance(kind, str):
        raise refused(f"replace: {process}", kind, "the name of a kind")
    return kind


def _twist(robot: str, twist: Any) -> str:
    try:
        v, omega = (float(number) for number in twist)
    except (TypeError, ValueError, OverflowError):
        raise refused(f"command: {robot}", twist, "a forward speed (m/s) and a turning rate (rad/s)") from None
    return f"{v!r},{omega!r}"


def _place(robot: str, pose: Any) -> str:
    try:
        numbers = [float(number) for number in pose]
    except (TypeError, ValueError, OverflowError):
        numbers = []
    if len(numbers) not in (2, 3):
        raise refused(f"place: {robot}", pose, "x (m), y (m) and perhaps a heading (rad)")
    return ",".join(map(repr, numbers))


def branch(log: str, at: float, seed: int, out: str | None, force: bool, change: list[str]) -> str:
    """Writes the log of a branch; returns its path."""
    call = ["branch", log, f"--at={at!r}", f"--seed={seed}", "--quiet", *change, *["--force"] * force]
    return str(json_of(call if out is None else [*call, f"--out={out}"])["log"])


def decided(log: str, moments: int, times: int, share: float, change: list[str]) -> dict[str, Any]:
    """The report of `protean decided`."""
    options = [f"--moments={moments}", f"--times={times}", f"--share={share!r}"]
    return json_of(["decided", log, "--quiet", *options, *change])
