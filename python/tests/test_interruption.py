"""Ctrl-C ends every call that works for long."""

import fcntl
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

SOURCES = [Path(__file__).parents[1] / folder for folder in ("src", "algorithms/src")]

#: What the calls below use.
PRELUDE = """
import json, os, select, signal, sys, time
from pathlib import Path
import numpy as np
import protean_robotics as pr

ENDLESS = {"rules.time_limit": 100000, "run.dt": 0.001}

def posts(count, every):
    blocked = np.zeros((count * every, count * every), dtype=bool)
    blocked[every // 2 :: every, every // 2 :: every] = True
    return blocked

def many(*point, count=5_000):
    return np.broadcast_to(point, (count, len(point)))

def stepped(**options):
    envs = pr.VectorEnv(**{"scenario": "chase_exact", "agents": ["evader_1"]} | options)
    envs.reset(seed=1)
    return envs

def ahead(robot):
    return 0.1 * robot.v_max, 0.0

def file(name, text):
    Path(name).write_text(text)
    return name

room = pr.Map.from_grid(posts(100, 8), 0.1)
"""

#: Repeats calls, each in a process of its own, and interrupts them.
RUNNER = """
for name, setup, call in json.load(sys.stdin):
    ours, theirs = os.pipe()
    child = os.fork()
    if child == 0:
        # As a terminal, which interrupts also the processes that a call has started.
        os.setpgid(0, 0)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        scope = dict(globals())
        exec(setup, scope)
        code = compile(call, name, "exec")
        os.write(theirs, b"begins")
        try:
            while True:
                exec(code, scope)
        except KeyboardInterrupt:
            os.write(theirs, b"interrupted")
        sys.exit(0)
    os.close(theirs)
    begins = os.read(ours, 99)
    time.sleep(float(os.environ["PAUSE"]))  # somewhere in it
    begin = time.monotonic()
    if begins:
        os.killpg(child, signal.SIGINT)
    is_ended, _, _ = select.select([ours], [], [], 20)
    took = time.monotonic() - begin
    outcome = os.read(ours, 99).decode() if is_ended else "goes on"
    if not is_ended:
        os.killpg(child, signal.SIGKILL)
    os.close(ours)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    print(json.dumps([name, outcome, took, status]), flush=True)
"""

#: Longest time until a call ends (s): Ctrl-C is seen within 50 ms and a block of items; the rest is for slow machines.
LONGEST = 2.0

ROOM = "map = room"
SMALL = "map = pr.Map.from_grid(posts(30, 8), 0.1)"
NEAR = "(0.85, 0.85), (23.25, 23.25)"
ENDS = "(0.85, 0.85), (79.25, 79.25)"
ENVS = "envs = stepped(num_envs=512, threads=THREADS, ticks_per_action=1_000_000, set=ENDLESS)"
STEP = "envs.step(np.zeros((512, 2)))"
ZIG_ZAG = "patrol = pr.patrol.ZigZag([(0, 0), (40, 0), (40, 40), (0, 40)], t_max=1.0, alpha=0.5)"
DISCS = "discs = [(i % 60 + 0.5, i // 60 + 0.5, 0.2) for i in range(3600)]"
LIMITS = "v_max=0.5, omega_max=2.0"

MAP = """
resolution = 0.02
max_cells = 25_000_000
bounds = { min = [0, 0], max = [100, 100] }
[[obstacles]]
shape.rectangle = { center = [50, 50], half_extents = [1, 1] }
"""
SCENARIO = """
[world]
map = "map.toml"
[[robots]]
name = "robot"
team = "evader"
start = { x = 1, y = 1, theta = 0 }
[[processes]]
kind = "evader_potential"
robots = ["robot"]
"""
EXPERIMENT = """
scenario = "big.toml"
seeds = { first = 1, count = 100 }
"""
GRID = """
scenario = "builtin:hello"
seeds = { first = 1, count = 2 }
[parameters.limit]
set = "rules.time_limit"
[grid]
limit = [0.1, 0.2]
"""
#: Files with a map of as many cells as a scenario may have.
FILES = f"file('map.toml', {MAP!r}); name = file('big.toml', {SCENARIO!r})"

#: Function that leaves the interpreter, by file and name: what calls of it need, and calls that take long or are repeated.
CALLS: dict[str, list[tuple[str, str]]] = {
    "coverage.rs:new": [(SMALL, "pr.coverage.Plan(map, (0.85, 0.85), 0.05, margin=0.0)")],
    "fields.rs:at_points": [
        ("goals = np.random.default_rng(1).uniform(0, 9, (1024, 2))", "pr.steering.attraction(many(4.0, 4.0), goals)"),
    ],
    "navigation.rs:arrival_times": [
        (ROOM, "pr.navigation.arrival_times(map, many(0.1, 0.1, count=1024), 1.0, 0.1, pitch=0.05)"),
    ],
    "navigation.rs:dominance": [
        (
            ROOM,
            "for i in range(9999): pr.navigation.dominance(map, [(0.1, 0.1)], 1.0, [(70.0, 70.0)], 1.0,"
            " radius=0.1 + 1e-4 * i, pitch=0.05)",
        ),
    ],
    "navigation.rs:shortest_paths": [
        (
            SMALL,
            f"for i in range(9999): pr.navigation.shortest_paths(map, {NEAR}, 0.2 + 1e-5 * i, count=1000)",
        ),
    ],
    "patrol.rs:detection": [
        (
            "from protean_robotics._core import patrol",
            "patrol.detection(np.arange(5000.0), many(1.0, 1.0), many(9.0, 9.0), 0.1, 9.0)",
        ),
    ],
    "patrol.rs:lap": [(ZIG_ZAG, "patrol.lap(100_000)")],
    "patrol.rs:predict": [(ZIG_ZAG, "patrol.predict(np.arange(1_000_000.0, 2_000_000.0))")],
    "rrt_star.rs:plan": [(ROOM, f"pr.rrt_star.plan(map, {ENDS}, 0.2, iterations=1_000_000)")],
    "tracking.rs:new": [
        (ROOM, f"pr.tracking.ParticleFilter(map, {LIMITS}, params={{'particles': 1_000_000}})"),
    ],
    "tracking.rs:update": [
        (
            f"{ROOM}; belief = pr.tracking.ParticleFilter(map, {LIMITS}, params={{'particles': 1_000_000}})",
            "belief.update(1.0, observers=many(0.1, 0.1, 0.0, count=64))",
        ),
    ],
    "tracking.rs:visibility": [
        (ROOM, "pr.tracking.visibility(map, many(0.1, 0.1, 0.0, count=64), many(9.1, 9.1))"),
    ],
    "trajectory.rs:plan": [
        (
            DISCS,
            f"pr.trajectory.plan((0, 0, 0), (60, 60), discs=discs, bounds=[(-5, -5), (65, 65)], clearance=0.1, {LIMITS})",
        ),
    ],
    "trajectory.rs:plan_instance": [
        (
            DISCS,
            "pr.trajectory.plan_instance({'cm_per_px': 1.0, 'vmax_px_s': 50, 'wmax_rad_s': 2, 'buffer_px': 1,"
            " 'bounds_px': [-500, -500, 6500, 6500], 'start': {'x': 0, 'y': 0, 'theta': 0}, 'goal': {'x': 6000, 'y': 6000},"
            " 'obstacles': [{'type': 'circle', 'x': 100 * x, 'y': 100 * y, 'r': 100 * r} for x, y, r in discs]})",
        ),
    ],
    "environments.rs:new": [
        (FILES, "pr.Env(name, agents=['robot'], observation='path')"),
    ],
    "environments.rs:replay": [
        (
            "envs = stepped(scenario='chase', num_envs=1, ticks_per_action=20_000, set=ENDLESS, agents=['evader']);"
            "envs.step(np.zeros((1, 2, 2)))",
            "envs.digest(0, running=True)",
        ),
    ],
    "environments.rs:render": [
        ("env = pr.Env('chase', agents=['evader_1'], render_mode='rgb_array'); env.reset(seed=1)", "env.render()"),
    ],
    "environments.rs:variant": [
        (
            f"{FILES}; env = pr.Env('hello', agents=['robot'], observation='path')",
            "for i in range(9999): env.reset(options={'set': {'world.map': 'map.toml', 'rules.time_limit': 1 + i}})",
        ),
    ],
    "environments.rs:write": [
        (ENVS.replace("THREADS", "1"), STEP),
        (ENVS.replace("THREADS", "2"), STEP),
        ("envs = pr.VectorEnv('chase', 10_000, agents=['evader_1'])", "envs.reset(seed=1)"),
        ("envs = pr.VectorEnv('chase', 10_000, agents=['evader_1'], threads=2)", "envs.reset(seed=1)"),
    ],
    "log/mod.rs:read": [
        (
            "pr.run('chase', in_process=True, out='log.mcap', set={'rules.time_limit': 60}); log = pr.Log('log.mcap')",
            "log.report(force=True)",
        ),
    ],
    "lab.rs:single_plans": [
        ("from protean_robotics._core import lab", "lab.single_plans(1, 100_000)"),
    ],
    "map/mod.rs:new": [(FILES, "pr.Map('map.toml')")],
    "map/mod.rs:path": [(SMALL, f"for i in range(9999): map.path({NEAR}, 0.2 + 1e-5 * i)")],
    "map/mod.rs:path_length": [(SMALL, "map.path_length(many(23.25, 23.25), (0.85, 0.85), 0.2)")],
    "map/mod.rs:clearance": [(ROOM, "map.clearance(many(0.1, 0.1))")],
    "map/mod.rs:line_is_clear": [(ROOM, "map.line_is_clear((0.1, 0.1), many(0.1, 79.9), 0.1)")],
    "map/mod.rs:free_run": [(ROOM, "map.free_run((0.1, 0.1), many(0.1, 79.9), 0.1)")],
    "map/mod.rs:cast_rays": [(ROOM, "map.cast_rays((0.1, 0.1), many(1.5)[:, 0], 100.0)")],
    "map/mod.rs:away_from_obstacles": [(ROOM, "map.away_from_obstacles(many(0.1, 0.1))")],
    "map/queries.rs:from_grid": [("grid = posts(600, 8)", "pr.Map.from_grid(grid, 0.1)")],
    "map/queries.rs:visible": [(ROOM, "map.visible((0.1, 0.1))")],
    "run.rs:run_in_process": [
        ("", "pr.run('hello', in_process=True, planners={'robot': ahead}, set=ENDLESS)"),
        (FILES, "pr.run(name, in_process=True)"),
    ],
    "sweep.rs:missions_to_run": [
        (
            f"{FILES}; name = file('sweep.toml', {EXPERIMENT!r})",
            "pr.sweep(name, in_process=True, quiet=True)",
        ),
    ],
    "sweep.rs:sweep_in_process": [
        (
            f"{FILES}; name = file('sweep.toml', {EXPERIMENT!r})",
            "pr.sweep(name, in_process=True, planners={'robot': ahead}, set=ENDLESS, quiet=True)",
        ),
    ],
    "sweep.rs:wait_for": [
        (
            "from protean_robotics.lab import claim, reproduce",
            "reproduce.run(Path('plans'), reproduce.Options([claim.Paper.VMC_LP], quiet=True))",
        ),
    ],
}
#: Executors of sweeps, and how they run missions.
EXECUTORS = {
    "threads": ("ThreadPoolExecutor(2)", "in_process=True, planners={'robot': ahead}"),
    "threads with programs": ("ThreadPoolExecutor(2)", "in_process=True"),
    "threads with missions of processes": ("ThreadPoolExecutor(2)", ""),
    "forked processes": ("ProcessPoolExecutor(2, get_context('fork'))", "in_process=True, planners={'robot': ahead}"),
    "processes": ("ProcessPoolExecutor(2, get_context('spawn'))", "in_process=True"),
    "processes of joblib": ("get_reusable_executor(2)", "in_process=True"),
}
#: Limits of the arguments bound these.
SHORT = {"coverage.rs:next", "lab.rs:patrol_laps", "routes.rs:plan_coverage", "routes.rs:plan_patrol"}
SHORT |= {"routes.rs:predict_patrol", "lab.rs:ros_map", "lab.rs:scenario_problems"}

def sources() -> list[tuple[str, str]]:
    """Names and texts of the sources in Rust."""
    return [(f"{path.relative_to(folder)}", path.read_text()) for folder in SOURCES for path in folder.rglob("*.rs")]


def functions() -> set[str]:
    """Functions that leave the interpreter."""
    found = set()
    for name, text in sources():
        for part in re.split(r"\bfn ", text)[1:]:
            if re.search(r"\b(wait|compute|each|short)\(\s*(py|at\.py\(\)|blocked\.py\(\)),", part):
                found.add(f"{name}:{re.split('[<(]', part)[0]}")
    return found


def test_no_function_leaves_the_interpreter_unseen() -> None:
    assert functions() == {*CALLS, *SHORT}
    direct = {name for name, text in sources() if "detach(" in text}
    # A planner's process ignores Ctrl-C: its run decides.
    assert direct == {"interpreter.rs", "interruptible.rs", "planner/entry.rs"}


def interrupted(cases: list[tuple[str, str, str]], longest: float = LONGEST, pause: float = 0.2) -> None:
    """Repeats calls, each in a process of its own, and interrupts them."""
    script = [sys.executable, "-c", PRELUDE + RUNNER]
    done = subprocess.run(
        script, input=json.dumps(cases), capture_output=True, text=True, check=False, env=os.environ | {"PAUSE": str(pause)}
    )
    results = [json.loads(line) for line in done.stdout.splitlines()]
    faults = [result for result in results if result[1::2] != ["interrupted", 0] or result[2] > longest]
    assert len(results) == len(cases) and not faults, (faults, done.stderr)


#: Longer than 10 s: it calls every function that leaves the interpreter, each in a process of its own.
def test_ctrl_c_ends_every_call_at_once() -> None:
    interrupted([(f"{name} ({i})", *case) for name, calls in CALLS.items() for i, case in enumerate(calls)])


#: Longer than 10 s: pools of processes start and end.
def test_ctrl_c_ends_sweeps_of_any_executor_and_nothing_half_written_remains(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setenv("TMPDIR", str(scratch))
    pytest.importorskip("joblib")
    setup = f"""
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from joblib.externals.loky import get_reusable_executor
file('map.toml', {MAP.replace("[100, 100]", "[10, 10]").replace("[50, 50]", "[5, 5]")!r})
file('big.toml', {SCENARIO!r})
file('sweep.toml', {EXPERIMENT!r})
"""
    cases = [
        (
            name,
            setup,
            f"with {pool} as executor:\n    pr.sweep('sweep.toml', executor=executor, set=ENDLESS, quiet=True, {options})",
        )
        for name, (pool, options) in EXECUTORS.items()
    ]
    # Processes of a pool start in this time; the missions of processes end in order.
    interrupted(cases, pause=1.5, longest=10.0)
    for path in scratch.glob("protean*"):
        # A pool kills the workers beside one that ended; `protean clean` removes what they leave, which nothing locks.
        fcntl.flock(os.open(path, os.O_RDONLY), fcntl.LOCK_EX | fcntl.LOCK_NB)
    assert not Path("results").exists()


def test_the_interpreter_may_end_while_an_abandoned_call_goes_on() -> None:
    script = f"""{PRELUDE}
signal.setitimer(signal.ITIMER_REAL, 0.2)
signal.signal(signal.SIGALRM, signal.default_int_handler)
try:
    pr.rrt_star.plan(room, {ENDS}, 0.2, iterations=1_000_000)
except KeyboardInterrupt:
    raise SystemExit(7)
"""
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False)
    assert (ended.returncode, ended.stderr) == (7, "")
