"""The mission as a test: `pytest`."""

from pathlib import Path

import protean_robotics as pr
from planner import steer

FOLDER = Path(__file__).parent
DIGEST = (FOLDER / "README.md").read_text().split("```text\n")[1].split("\n")[0]


def test_the_robot_reaches_its_goal_with_the_digest_of_the_readme() -> None:
    run = pr.run(FOLDER / "hall.toml", seed=1, allow_external=True)
    assert run.outcome == {"robot": "goal_reached"}
    assert run.digest == DIGEST


def test_a_run_in_one_thread_has_the_same_digest() -> None:
    run = pr.run(FOLDER / "hall.toml", seed=1, in_process=True, planners={"my_planner": steer})
    assert run.digest == DIGEST
