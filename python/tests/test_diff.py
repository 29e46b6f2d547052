"""Differences of runs whose planner in Python steers otherwise from a tick on."""

import json
import random
import subprocess
from pathlib import Path
from typing import Any

import pytest

import protean_robotics as pr

TICKS = 40


def steered(log: str, changed: int | None = None, field: str = "omega") -> Path:
    """Log of a chase with an evader in Python, which steers a little otherwise from a tick on."""

    @pr.planner
    def steer(robot: pr.Robot, world: pr.World) -> tuple[float, float]:
        # Half of it, so that no limit hides a change.
        v, omega = (0.5 * value for value in pr.go_to(robot, world.exits[0]))
        if changed is None or round(world.time * 20) < changed:
            return v, omega
        return (v + 1e-9, omega) if field == "v" else (v, omega + 1e-9)

    settings: dict[str, Any] = {"set": {"rules.time_limit": TICKS / 20}, "in_process": True}
    pr.run("chase", seed=3, planners={"evader_1": steer}, out=log, **settings)
    return Path(log)


def differences(a: Path, b: Path) -> Any:
    """Report of `protean diff`."""
    command = [str(pr.program()), "diff", str(a), str(b), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode in (0, 1), done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Log of the planner as it is."""
    return steered(str(tmp_path_factory.mktemp("logs") / "original.mcap"))


def test_a_repetition_has_no_difference(original: Path) -> None:
    report = differences(original, steered("again.mcap"))
    assert report["same"] and report["whole"] and report["first"] is None


@pytest.mark.parametrize("seed", range(20))
def test_the_planner_that_steers_otherwise_is_named(original: Path, seed: int) -> None:
    rng = random.Random(seed)
    changed, field = rng.randrange(TICKS), rng.choice(["v", "omega"])
    report = differences(original, steered("changed.mcap", changed, field))
    found = [
        (cause["tick"], cause["process"], cause["robot"], cause["topic"], cause["field"])
        for cause in report["first"]["causes"]
    ]
    assert found == [(changed, "evader_potential_evader_1", "evader_1", "robot/command", field)]
    assert report["first"]["effects"] == []
    assert report["topics"]["robot/command"]["first_tick"] == changed
