"""Branches of runs: the past is that of the log, the future has the change."""

from pathlib import Path

import numpy as np
import pytest

import protean_robotics as pr


@pytest.fixture(scope="module")
def chase(tmp_path_factory: pytest.TempPathFactory) -> pr.Run:
    out = tmp_path_factory.mktemp("logs") / "chase.mcap"
    return pr.run("chase_exact", seed=2, set={"rules.time_limit": 12}, in_process=True, out=out)


def test_a_branch_has_the_past_of_its_log_and_another_future(chase: pr.Run, tmp_path: Path) -> None:
    branch = chase.branch(6.0, set={"teams.police.limits.v_max": 0.05}, out=tmp_path / "slow.mcap")
    before, after = (log["world/state"].to_numpy() for log in (chase.log, branch))
    past = before["stamp.time_ns"] <= 6_000_000_000
    columns = ("stamp.tick", "robots.robot", "robots.x", "robots.y", "robots.theta")
    for name in columns:
        np.testing.assert_array_equal(before[name][past], after[name][after["stamp.time_ns"] <= 6_000_000_000])
    police = after["robots.team"] == 1
    assert after["robots.v"][police & (after["stamp.time_ns"] > 7_000_000_000)].max() <= 0.05 + 1e-12
    # A branch without a change is its parent, and can be branched itself.
    same = chase.branch(6.0, out=tmp_path / "same.mcap")
    assert same.digest == chase.digest != branch.digest
    assert branch.branch(9.0, out=tmp_path / "again.mcap").digest == branch.digest


def test_a_command_counts_for_its_time(tmp_path: Path) -> None:
    run = pr.run("hello", seed=1, in_process=True, out=tmp_path / "hello.mcap")
    branch = run.branch(2.0, command={"robot": (0.0, 0.5)}, duration=1.0, out=tmp_path / "turn.mcap")
    state = branch["world/state"].to_numpy()
    t, omega = state["stamp.time_ns"] * 1e-9, state["robots.omega"]
    held = (t > 2.1) & (t < 2.9)
    assert np.all(omega[held] == pytest.approx(0.5)) and np.all(state["robots.v"][held] == pytest.approx(0.0))


def test_a_robot_goes_on_from_the_place_that_it_is_given(tmp_path: Path) -> None:
    run = pr.run("hello", seed=1, in_process=True, out=tmp_path / "hello.mcap")
    state = run.log["world/state"].to_numpy()
    start = state["stamp.tick"] == 0
    x, y = float(state["robots.x"][start][0]), float(state["robots.y"][start][0])
    branch = run.branch(2.0, place={"robot": (x, y, 0.25)}, out=tmp_path / "moved.mcap")
    state = branch["world/state"].to_numpy()
    moved = state["stamp.time_ns"] == 2_000_000_000
    found = [state[f"robots.{name}"][moved][0] for name in ("x", "y", "theta")]
    assert found == pytest.approx([x, y, 0.25])


def test_values_are_drawn_from_their_range(chase: pr.Run, tmp_path: Path) -> None:
    speeds = []
    for seed in (1, 2):
        draw = {"teams.police.limits.v_max": (0.04, 0.06)}
        branch = chase.branch(6.0, draw=draw, seed=seed, out=tmp_path / f"{seed}.mcap")
        state = branch["world/state"].to_numpy()
        police = (state["robots.team"] == 1) & (state["stamp.time_ns"] > 7_000_000_000)
        speeds.append(state["robots.v"][police].max())
    assert 0.04 <= min(speeds) < max(speeds) <= 0.06
    with pytest.raises(pr.InvalidInput, match="LOW < HIGH"):
        chase.branch(6.0, draw={"teams.police.limits.v_max": (2.0, 1.0)}, out=tmp_path / "none.mcap")


def test_outcomes_are_decided_at_a_moment_or_not_before_the_end(chase: pr.Run) -> None:
    report = chase.decided(moments=3, continuations=4, share=0.5)
    assert [moment["continuations"] >= 4 for moment in report["moments"]] == [True] * len(report["moments"])
    assert len(report["moments"]) >= 3
    for decision in report["decisions"]:
        assert decision["outcome"] == chase.outcome[decision["robot"]]
        low, high = decision.get("between_s", (0.0, 0.0))
        assert 0.0 <= low <= high <= decision["time_s"]


PLANNER = """
import protean_robotics as pr

@pr.planner
def steer(robot: pr.Robot) -> tuple[float, float]:
    return 0.1, 0.3

if __name__ == "__main__":
    pr.serve(steer)
"""
MISSION = """
world.map = "builtin:hello"
rules.time_limit = 2.0
robots = [{ name = "robot", team = "neutral", start = { x = 0.5, y = 0.5, theta = 0.0 } }]
processes = [{ name = "mine", command = ["python3", "mine.py"], robots = ["robot"] }]
"""


def test_a_run_of_a_program_in_python_is_branched_with_it(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(PLANNER)
    (tmp_path / "mission.toml").write_text(MISSION)
    run = pr.run(tmp_path / "mission.toml", allow_external=True, out=tmp_path / "run.mcap")
    same = run.branch(1.0, allow_external=True, out=tmp_path / "same.mcap")
    assert same.digest == run.digest
    stopped = run.branch(1.0, command={"robot": (0.0, 0.0)}, allow_external=True, out=tmp_path / "stopped.mcap")
    assert stopped.digest != run.digest
    report = run.decided(moments=1, continuations=2, share=0.5, allow_external=True)
    assert report["moments"][0]["continuations"] >= 2
    with pytest.raises(pr.InvalidInput, match="external programs"):
        run.branch(1.0)


def test_what_cannot_be_branched_is_refused(chase: pr.Run, tmp_path: Path) -> None:
    with pytest.raises(pr.InvalidInput, match="at|--at"):
        chase.branch(1000.0)
    with pytest.raises(pr.InvalidInput, match="expected a forward speed"):
        chase.branch(1.0, command={"police_1": 3.0})
    with pytest.raises(pr.InvalidInput, match=r"expected x \(m\), y \(m\) and perhaps a heading"):
        chase.branch(1.0, place={"police_1": (3.0,)})
    with pytest.raises(pr.InvalidInput, match="outside the map"):
        chase.branch(1.0, place={"police_1": (1e3, 0.0)}, out=tmp_path / "outside.mcap")
    assert not (tmp_path / "outside.mcap").exists()
    with pytest.raises(pr.InvalidInput, match="expected the name of a kind"):
        chase.branch(1.0, replace={"pursuer_police_1": 3})
    without = pr.run("hello", seed=1, in_process=True)
    with pytest.raises(pr.InvalidInput, match="the run has no log"):
        without.branch(1.0)
