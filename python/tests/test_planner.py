"""Planners: their inputs, results and failures, as processes and in one thread."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import protean_robotics as pr

#: A room with an exit; a planner of a program steers.
ROOM = """
[world]
map = "builtin:hello"
[rules]
exits = [{ circle = { center = [3.5, 2.5], radius = 0.2 } }]
time_limit = 20.0
[[robots]]
name = "robot"
team = "evader"
start = { x = 0.5, y = 2.5, theta = 1.0 }
scan = { beams = 8 }
[[processes]]
name = "planner"
command = ["python3", "planner.py"]
robots = ["robot"]
params = { speed = 0.8 }
"""

#: The smallest planner, and one with a memory and all inputs.
SMALL = """
import protean_robotics as pr

@pr.planner
def steer(robot, world, map):
    return pr.go_to(robot, world.exits[0])

if __name__ == "__main__":
    pr.serve(steer)
"""
LARGE = """
import protean_robotics as pr

@pr.planner
class Wanderer:
    def __init__(self, robot, params, rng):
        self.speed = params["speed"] * robot.v_max
        self.rng = rng

    def __call__(self, map, scan, world, robot):
        assert map.revision > 0 and (scan is None or scan.ranges.shape == (8,))
        v, omega = pr.go_to(robot, world.exits[0])
        return pr.Steering(min(v, self.speed), omega + self.rng.normal(scale=0.5), waypoint=world.exits[0])

if __name__ == "__main__":
    pr.serve(Wanderer)
"""


def planner_of(text: str) -> pr.Planner:
    """Planner of a program, which also is a file."""
    Path("planner.py").write_text(text)
    Path("room.toml").write_text(ROOM)
    names: dict[str, Any] = {"__name__": "planner"}
    exec(compile(text, "planner.py", "exec"), names)
    return next(value for value in names.values() if isinstance(value, pr.Planner))


@pytest.mark.parametrize("text", [SMALL, LARGE])
def test_a_planner_has_one_digest_as_a_process_and_in_one_thread(text: str) -> None:
    steer = planner_of(text)
    by_processes = pr.run("room.toml", allow_external=True)
    in_one_thread = pr.run("room.toml", in_process=True, planners={"planner": steer}, out="thread.mcap")
    assert by_processes.outcome == in_one_thread.outcome == {"robot": "escaped"}
    assert by_processes.digest == in_one_thread.digest
    # The log of the thread names the program, so that its run can be repeated with processes.
    verified = subprocess.run(
        [pr.program(), "verify", "thread.mcap", "--allow-external"], capture_output=True, text=True, check=False
    )
    assert verified.returncode == 0, verified.stdout + verified.stderr


def test_the_smallest_planner_has_at_most_ten_lines() -> None:
    assert len(SMALL.strip().splitlines()) <= 10


def test_a_planner_takes_the_place_of_a_built_in_one() -> None:
    seen: list[Any] = []

    @pr.planner
    def steer(robot: pr.Robot, world: pr.World, rng: np.random.Generator) -> tuple[float, float]:
        seen.append((world.time, robot.x, len(world.opponents), rng.random()))
        assert world.poses.shape == (6, 3)
        np.testing.assert_array_equal(world.poses[robot.index], robot.pose)
        assert [r.name for r in world.robots if r.team == robot.team and r is not robot] == [
            r.name for r in world.teammates
        ]
        return robot.v_max, 0.0

    settings: dict[str, Any] = {"seed": 3, "set": {"rules.time_limit": 2}, "in_process": True}
    run = pr.run("chase", planners={"evader_1": steer}, **settings)
    first, seen = seen, []
    assert pr.run("chase", planners={"evader_1": steer}, **settings).digest == run.digest
    assert pr.run("chase", **settings).digest != run.digest
    assert seen == first
    assert len(seen) == 40
    assert seen[0][2] == 4
    # Of a team, all robots; of a process, its robots.
    both = pr.run("chase", planners={"evader": steer}, **settings)
    assert len(seen) == 120
    assert both.digest != run.digest
    process = "evader_potential_evader_1"
    assert pr.run("chase", planners={process: steer}, **settings).digest == run.digest


def test_beliefs_are_those_of_perception() -> None:
    means: list[Any] = []

    @pr.planner
    def steer(robot: pr.Robot, belief: dict[str, pr.Belief]) -> tuple[float, float]:
        for name, known in belief.items():
            assert known.robot.name == name
            assert known.particles.dtype == np.float32
            assert known.particles.shape[1] == 4
            weights = known.particles[:, 3].astype(float)
            mean = weights @ known.particles[:, :2].astype(float) / weights.sum()
            np.testing.assert_allclose(mean, known.mean[:2], atol=1e-3)
            means.append(known.mean)
        return 0.0, 0.0

    pr.run("chase", set={"rules.time_limit": 1}, in_process=True, planners={"police_1": steer})
    assert len(means) == 2 * 20


def test_an_exception_ends_the_run_with_its_traceback() -> None:
    @pr.planner
    def broken(robot: pr.Robot) -> tuple[float, float]:
        return 1.0, 1 / 0

    planner_of(SMALL)
    with pytest.raises(pr.Error, match="process planner failed at tick 0") as raised:
        pr.run("room.toml", in_process=True, planners={"planner": broken})
    assert isinstance(raised.value.__cause__, ZeroDivisionError)
    assert "return 1.0, 1 / 0" in str(raised.value)
    Path("planner.py").write_text(SMALL.replace("world.exits[0]", "world.exits[7]"))
    with pytest.raises(pr.Error, match="IndexError") as raised:
        pr.run("room.toml", allow_external=True)
    assert "pr.go_to(robot, world.exits[7])" in str(raised.value)


@pytest.mark.parametrize(
    ("result", "text"),
    [
        ("float('nan'), 0.0", "v = NaN"),
        ("0.0, float('inf')", "omega = inf"),
        ("None", "returned None: expected"),
        ("1.0", "returned 1.0: expected"),
        ("(1.0, 2.0, 3.0)", "expected"),
        ("'ab'", "returned 'ab': expected"),
    ],
)
def test_a_result_that_is_no_command_is_named(result: str, text: str) -> None:
    steer = planner_of(SMALL.replace("pr.go_to(robot, world.exits[0])", result))
    with pytest.raises(pr.Error, match=text.replace("(", r"\(")):
        pr.run("room.toml", in_process=True, planners={"planner": steer})


def test_commands_beyond_the_limits_are_clipped() -> None:
    steer = planner_of(SMALL.replace("pr.go_to(robot, world.exits[0])", "1e9, -1e9"))
    run = pr.run("room.toml", in_process=True, planners={"planner": steer}, set={"rules.time_limit": 1})
    assert run.summary["robots"][0]["distance_m"] < 1.0


def test_unknown_inputs_and_processes_are_named() -> None:
    with pytest.raises(ValueError, match='"sonar" of a planner: expected one of robot, world'):
        pr.planner(lambda sonar: (0.0, 0.0))
    with pytest.raises(pr.InvalidInput, match="planner = 3: expected a function or a class"):
        pr.planner(3)  # type: ignore[arg-type]
    steer = planner_of(SMALL)
    with pytest.raises(pr.InvalidInput, match='no robot, team or process "pilot": expected one of police_1,'):
        pr.run("chase", in_process=True, planners={"pilot": steer})
    with pytest.raises(pr.InvalidInput, match='process "perception" steers no robot'):
        pr.run("chase", in_process=True, planners={"perception": steer})
    with pytest.raises(pr.InvalidInput, match="expected in_process=True"):
        pr.run("chase", planners={"evader_1": steer})
    with pytest.raises(pr.InvalidInput, match="check them, then add allow_external=True"):
        pr.run("room.toml")


def test_a_planner_that_no_run_has_started_says_so() -> None:
    planner_of(SMALL)
    done = subprocess.run([sys.executable, "planner.py"], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "steer: a run of protean starts this program" in done.stderr


def test_a_configuration_of_another_version_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    planner_of(SMALL)
    (tmp_path / "config.json").write_text('{"run": {"from": "another version"}}')
    monkeypatch.setenv("PROTEAN_CONFIG", str(tmp_path / "config.json"))
    done = subprocess.run([sys.executable, "planner.py"], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "expected a program built from the version of `protean`" in done.stderr
