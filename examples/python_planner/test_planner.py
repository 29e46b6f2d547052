"""The mission as a test: `pytest`. The package brings the fixture `mission`."""

from collections.abc import Callable
from pathlib import Path

import protean_robotics as pr
from planner import steer

DIGEST = (Path(__file__).parent / "README.md").read_text().split("```text\n")[1].split("\n")[0]


def test_the_robot_reaches_its_goal_with_the_digest_of_the_readme(mission: Callable[..., pr.Run]) -> None:
    run = mission("hall.toml", seed=1, in_process=False, allow_external=True)
    assert run.outcome == {"robot": "goal_reached"}
    assert run.digest == DIGEST


def test_a_run_in_one_thread_has_the_same_digest(mission: Callable[..., pr.Run]) -> None:
    run = mission("hall.toml", seed=1, planners={"my_planner": steer})
    assert run.digest == DIGEST
