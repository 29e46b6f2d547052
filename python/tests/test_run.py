"""Runs of missions, by processes and in one thread."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import protean_robotics as pr

SHORT = {"rules.time_limit": 3}


def test_processes_one_thread_and_the_command_have_one_digest() -> None:
    by_processes = pr.run("chase", seed=7, set=SHORT)
    in_one_thread = pr.run("chase", seed=7, set=SHORT, in_process=True)
    command = [pr.program(), "run", "chase", "--seed=7", "--set=rules.time_limit=3", "--json", "--quiet", "--out=c.mcap"]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    assert by_processes.digest == in_one_thread.digest
    assert f'"digest":"{by_processes.digest}"' in text.replace('": "', '":"')
    assert by_processes.outcome == in_one_thread.outcome
    assert by_processes.log.path == by_processes.log_path == Path("logs/chase-7.mcap")
    assert in_one_thread.log_path is None
    with pytest.raises(pr.InvalidInput, match="no log: expected out=PATH"):
        _ = in_one_thread.log
    assert pr.run("chase", seed=8, set=SHORT, in_process=True).digest != by_processes.digest


def test_values_of_all_types_replace_those_of_the_scenario() -> None:
    values = {
        "rules.time_limit": np.float64(1.5),
        "rules.exits": [{"circle": {"center": np.array([3.5, 2.5]), "radius": 0.2}}],
        "run.mode": "lock_step",
        "title": 'A "quoted" title',
    }
    run = pr.run("hello", set=values, in_process=True)
    assert run.time == 1.5


@pytest.mark.parametrize("in_process", [True, False])
def test_invalid_input_is_an_exception_with_the_text_of_the_command(in_process: bool) -> None:
    with pytest.raises(pr.InvalidInput, match=r"rules\.time_limit(.|\n)*-1") as raised:
        pr.run("hello", set={"rules.time_limit": -1}, in_process=in_process)
    command = [pr.program(), "check", "hello", "--set=rules.time_limit=-1"]
    text = subprocess.run(command, capture_output=True, text=True, check=False).stderr
    assert str(raised.value).splitlines()[0] in text
    with pytest.raises(pr.InvalidInput, match="nowhere.toml"):
        pr.run("nowhere.toml", in_process=in_process)
    assert not Path("logs").exists()


@pytest.mark.parametrize("in_process", [True, False])
def test_an_existing_log_is_kept_unless_force(in_process: bool) -> None:
    Path("kept.mcap").write_bytes(b"precious")
    with pytest.raises(pr.Error, match="kept.mcap"):
        pr.run("hello", set=SHORT, in_process=in_process, out="kept.mcap")
    assert Path("kept.mcap").read_bytes() == b"precious"
    run = pr.run("hello", set=SHORT, in_process=in_process, out=Path("kept.mcap"), force=True)
    assert run.log_path == Path("kept.mcap")
    assert Path("kept.mcap").stat().st_size > 1000


@pytest.mark.parametrize("in_process", [True, False])
def test_ctrl_c_ends_a_run_in_order_and_raises(in_process: bool, tmp_path: Path) -> None:
    # It lasts until it is stopped: at the speed of the clock, and a patrol without end.
    name, mode = ("patrol_square", "lock_step") if in_process else ("chase", "real_time")
    script = f"""
import protean_robotics as pr
print("begins", flush=True)
values = {{"rules.time_limit": 100000, "run.mode": "{mode}"}}
try:
    pr.run("{name}", set=values, in_process={in_process}, out="stopped.mcap")
except KeyboardInterrupt:
    print("interrupted")
"""
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, cwd=tmp_path) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "begins\n"
        log = tmp_path / "stopped.mcap"
        # A run that has not begun leaves no log: wait for its messages. What is before them has less than 300 kB.
        while not log.exists() or log.stat().st_size < 500_000:
            assert process.poll() is None
            time.sleep(0.01)
        os.kill(process.pid, signal.SIGINT)
        output, _ = process.communicate(timeout=60)
    assert output == "interrupted\n"
    info = subprocess.run([pr.program(), "info", log], capture_output=True, text=True, check=True)
    assert "digest" in info.stdout
