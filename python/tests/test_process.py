"""The package follows what Python does with its process: its end, forks and Ctrl-C."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

#: Work in a daemon thread, which never ends.
WORK = {
    "run": "pr.run('chase', in_process=True)",
    "step": "envs.step(np.zeros((4, 2), np.float32))",
    "step with planners": "planned.step(np.zeros((4, 2), np.float32))",
    "map": "map.path((-9.0, -9.0), (9.0, 9.0), 0.1)",
    "rrt_star": "pr.rrt_star.plan(map, (-9.0, -9.0), np.array([[9.0, 9.0]]), 0.1)",
    "log": "pr.Log('hello.mcap')['world/state'].to_numpy()",
    "planner": "pr.run('hello', in_process=True, planners={'robot': ahead}, set=ENDLESS)",
    "planner that does not return": "pr.run('hello', in_process=True, planners={'robot': hangs})",
}
END = """
import threading, time
import numpy as np
import protean_robotics as pr

ENDLESS = {"rules.time_limit": 100000, "run.dt": 0.001}

def ahead(robot, map):
    map.clearance(robot)
    return 0.1, 0

def hangs(robot):
    while True:
        begun.set()

begun = threading.Event()
map = pr.Map("chase")
envs = pr.VectorEnv("chase", 4, agents=["evader_1"])
planned = pr.VectorEnv("chase_exact", 4, agents=["evader_1"], planners={"police": ahead})
envs.reset(seed=1)
planned.reset(seed=1)
pr.run("hello", in_process=True, out="hello.mcap", force=True)

def work():
    begun.set()
    while True:
        WORK

threading.Thread(target=work, daemon=True).start()
begun.wait()
time.sleep(0.2)  # somewhere in it
print("ends", flush=True)
raise SystemExit(7)
"""


@pytest.mark.parametrize("name", WORK)
def test_the_interpreter_may_end_while_a_thread_is_in_the_package(name: str) -> None:
    script = [sys.executable, "-c", END.replace("WORK", WORK[name])]
    for _ in range(3):
        ended = subprocess.run(script, capture_output=True, text=True, timeout=60, check=False)
        assert (ended.returncode, ended.stdout) == (7, "ends\n"), ended.stderr


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("stepped", [False, True])
def test_a_forked_child_is_told_that_its_parent_made_the_environments(threads: int, stepped: bool) -> None:
    script = f"""
import os, sys
import numpy as np
import protean_robotics as pr
envs = pr.VectorEnv("chase", 4, agents=["evader_1"], threads={threads})
envs.reset(seed=1)
actions = np.zeros((4, 2), np.float32)
if {stepped}:
    envs.step(actions)
child = os.fork()
if child == 0:
    for call in (envs.reset, lambda: envs.step(actions), lambda: envs.episode(0, running=True)):
        try:
            call()
        except pr.Error as error:
            print(error, flush=True)
    own = pr.VectorEnv("chase", 4, agents=["evader_1"], threads={threads})
    own.reset(seed=1)
    del envs
    sys.exit(5)
_, status = os.waitpid(child, 0)
envs.step(actions)
print(os.waitstatus_to_exitcode(status))
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False)
    *refusals, status = done.stdout.splitlines()
    assert status == "5", done.stderr
    assert len(refusals) == 3 and all("made in another process" in refusal for refusal in refusals)


@pytest.mark.parametrize("body", ["pass", "time.sleep(0.5)"])
def test_a_second_ctrl_c_ends_a_planner_that_does_not_return(body: str, tmp_path: Path) -> None:
    script = f"""
import time
import protean_robotics as pr

def hangs(robot):
    print("hangs", flush=True)
    while True:
        {body}

try:
    pr.run("hello", in_process=True, planners={{"robot": hangs}})
except KeyboardInterrupt:
    print("interrupted")
"""
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, cwd=tmp_path) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "hangs\n"
        os.kill(process.pid, signal.SIGINT)
        # Two signals at once are one; a user takes longer.
        time.sleep(0.5)
        os.kill(process.pid, signal.SIGINT)
        output, _ = process.communicate(timeout=30)
    assert output == "interrupted\n"
