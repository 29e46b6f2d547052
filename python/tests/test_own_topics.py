"""Processes with topics of their own: declarations, messages and failures, as processes and in one thread."""

import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import protean_robotics as pr

EXAMPLE = Path(__file__).parents[2] / "examples/external_sensor"


def call(*arguments: str) -> str:
    """Output of the program, which succeeds."""
    done = subprocess.run([pr.program(), *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def module(path: Path) -> Any:
    """Module of a file."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = found
    spec.loader.exec_module(found)
    return found


def test_the_example_has_one_digest_with_processes_and_in_one_thread_and_a_log_that_ros_reads() -> None:
    for file in ("bearings.py", "bearings.toml"):
        shutil.copy(EXAMPLE / file, file)
    assert len(Path("bearings.py").read_text().splitlines()) <= 40
    own = module(Path("bearings.py"))
    processes = {"sensor": own.sensor, "tracker": own.tracker}
    planners = {"chaser_north": own.chaser, "chaser_south": own.chaser}
    by_thread = pr.run("bearings.toml", in_process=True, planners=planners, processes=processes, out="thread.mcap")
    by_processes = pr.run("bearings.toml", allow_external=True, out="processes.mcap")
    assert by_thread.digest == by_processes.digest
    ticks = by_thread.summary["ticks"]
    assert by_thread.summary["topics"]["sonar/track"]["messages"] == ticks
    # The planners follow the tracker: they come near the robot that they see by its bearings alone.
    assert by_thread.summary["robots"][0]["distance_m"] > 1.0
    # Logs of both name the programs and contain their declarations.
    assert "identical" in call("verify", "thread.mcap", "--allow-external")
    for name in ("sensor", "tracker", "chaser_north"):
        assert "IDENTICAL" in call("replay", "processes.mcap", "--test", name, "--allow-external")
    call("export", "processes.mcap", "--out", "tables")
    table = Path("tables/sonar.bearing.csv").read_text().splitlines()
    assert "elements.angle" in table[0] and len(table) == 1 + 2 * ticks
    rosbags = pytest.importorskip("rosbags.highlevel")
    counts = {"sonar/bearing": 0, "sonar/track": 0}
    with rosbags.AnyReader([Path("processes.mcap")]) as reader:
        for connection, _, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            if connection.topic in counts:
                counts[connection.topic] += 1
                assert all(np.isfinite(element.x) for element in message.elements)
    assert counts == {"sonar/bearing": ticks, "sonar/track": ticks}


#: A writer within the tick, one for the next tick, and a reader of both and of built-in topics.
PROGRAM = """
import numpy as np
import protean_robotics as pr

INNER = np.dtype([("pose", "f8", (3,)), ("count", "i4"), ("small", "i2"), ("flags", "u1", (2,))])
EARLY = pr.Output([("inner", INNER), ("noise", "f4"), ("robot", "u4")], may_be_infinite=["noise"])

@pr.process(writes={"own/early": EARLY})
def early(world, rng, params):
    return [(((r.x, r.y, r.theta), len(world.robots), -1, (1, 2)), params["scale"] * rng.normal(), r.index)
            for r in world.robots]

@pr.process(writes={"own/later": pr.Output([("time", "f8")], later=True)})
def later(world):
    return np.array([(world.time,)], [("time", "f8")])

@pr.process(reads=["own/early", "own/later", "world/state", "world/map", "robot/plan", "robot/scan"],
            writes={"own/sum": [("parts", "f8", (6,))]})
def total(inputs, world):
    messages = {name: [m.elements for m in own] for name, own in inputs.items()}
    state = inputs["world/state"][0]
    np.testing.assert_array_equal(state.elements["x"], world.poses[:, 0])
    assert not state.elements.flags.writeable
    assert state.header["stamp"]["tick"] == round(world.time / world.dt)
    early = np.concatenate(messages["own/early"])
    np.testing.assert_array_equal(early["inner"]["pose"], world.poses)
    # Those for the next tick are of the tick before, in any order of steps.
    times = [float(m["time"][0]) for m in messages["own/later"]]
    assert len(times) == (world.time > 0) and all(abs(t + world.dt - world.time) < 1e-9 for t in times)
    assert len(inputs["world/map"]) == 1 and len(inputs["robot/scan"]) == 1
    assert len(inputs["robot/plan"]) == (world.time > 0)
    plan = [float(m["x"].sum()) for m in messages["robot/plan"]]
    return {"own/sum": [((early["noise"].sum(), sum(times), sum(plan), messages["world/map"][0].size,
                          messages["robot/scan"][0].size, 0.0),)]}

@pr.planner(reads=["own/sum"])
def steer(robot, inputs):
    return 0.1 * robot.v_max, float(np.sign(inputs["own/sum"][0].elements["parts"][0, 0]))

if __name__ == "__main__":
    pr.serve(early, later, total, steer)
"""
SCENARIO = """
[world]
map = "builtin:hello"
[rules]
exits = [{ circle = { center = [3.5, 2.5], radius = 0.2 } }]
time_limit = 1.0
[[robots]]
name = "robot"
team = "evader"
start = { x = 0.5, y = 2.5, theta = 1.0 }
scan = { beams = 8 }
[[processes]]
name = "steer"
command = ["python3", "own.py", "steer"]
robots = ["robot"]
""" + "".join(
    f"""
[[processes]]
name = "{name}"
command = ["python3", "own.py", "{name}"]
declaration = "ask"
params = {{ scale = 2.0 }}
"""
    for name in ("total", "later", "early")
)


def test_messages_of_own_and_of_built_in_topics_arrive_in_the_tick_for_which_they_count() -> None:
    Path("own.py").write_text(PROGRAM)
    Path("own.toml").write_text(SCENARIO)
    own = module(Path("own.py"))
    by_thread = pr.run(
        "own.toml",
        in_process=True,
        planners={"steer": own.steer},
        processes={name: getattr(own, name) for name in ("early", "later", "total")},
        out="own.mcap",
    )
    by_processes = pr.run("own.toml", allow_external=True)
    assert by_thread.digest == by_processes.digest
    table = by_thread.log["own/early"].to_numpy()
    assert table["elements.inner.count"].tolist() == [1] * by_thread.summary["ticks"]


@pytest.mark.parametrize(
    ("topic", "fields", "text"),
    [
        ("sonar/echo", [("range", "f8"), ("valid", "?")], "field valid: type bool: expected f4, f8,"),
        ("sonar/echo", [("name", "U8")], "field name: type <U8"),
        ("sonar/echo", [("range", ">f8")], "field range: type >f8"),
        ("sonar/echo", [("grid", "f8", (2, 2))], "field grid: .*expected an array of one dimension"),
        ("sonar/echo", [("inner", [("when", "M8[s]")])], "field inner.when"),
        ("sonar/echo", [("range", "f8"), ("robot", "u4")], "12 bytes: expected a multiple of 8"),
        ("sonar/echo", [("robot", "u4"), ("range", "f4"), ("far", "f8")], 'field "far".*largest numbers in the first'),
        ("sonar/echo", [("range", "f8"), ("a", "u1"), ("robot", "u2")], 'field "robot": it begins at byte 9'),
        ("sonar/echo", [("Range", "f8")], 'field "Range": expected a name'),
        ("sonar/echo", "f8", "expected a structured type"),
        ("sonar", [("range", "f8")], "expected a name of lower-case words"),
        ("world/state", [("range", "f8")], "expected a name that Protean's own topics do not have"),
    ],
)
def test_an_unsuitable_topic_is_refused_with_its_field(topic: str, fields: Any, text: str) -> None:
    with pytest.raises(pr.InvalidInput, match=text):
        pr.process(writes={topic: fields})(lambda: [])


def test_one_name_has_one_layout_and_a_drawing_names_its_fields() -> None:
    pr.process(writes={"twice/echo": [("range", "f8")]})(lambda: [])
    pr.process(writes={"twice/echo": [("range", "f8")]})(lambda: [])
    with pytest.raises(pr.InvalidInput, match="expected the messages that this program knows:\nfloat64 range"):
        pr.process(writes={"twice/echo": [("bearing", "f8")]})(lambda: [])
    for drawing, text in [({"x": "x"}, "expected x and y"), ({"x": "x", "y": "robot"}, 'field "robot"'), ({"z": "x"}, '"z"')]:
        with pytest.raises(pr.InvalidInput, match=text):
            echo = pr.Output([("x", "f8"), ("robot", "u8")], drawing=drawing)
            pr.process(writes={"drawn/echo": echo})(lambda: [])
    with pytest.raises(pr.InvalidInput, match='"robot" of a process: expected one of world, inputs, params, rng'):
        pr.process(writes={})(lambda robot: [])


@pytest.mark.parametrize(
    ("result", "text"),
    [
        ("{'own/echo': []}", 'topic "own/echo": expected one of own/later'),
        ("3.0", "an array of 0 dimensions"),
        ("'no'", "elements of own/later"),
        ("[(0.0,)] * 65", "65 elements exceeds the capacity of 64"),
        ("1 / 0", "ZeroDivisionError"),
    ],
)
def test_a_result_that_is_no_message_ends_the_run(result: str, text: str) -> None:
    Path("own.py").write_text(PROGRAM.replace("np.array([(world.time,)], [(\"time\", \"f8\")])", result))
    Path("own.toml").write_text(SCENARIO)
    with pytest.raises(pr.Error, match=text):
        pr.run("own.toml", allow_external=True)


def test_programs_and_names_that_do_not_fit_are_refused_before_the_run() -> None:
    Path("own.py").write_text(PROGRAM)
    Path("own.toml").write_text(SCENARIO)
    own = module(Path("own.py"))
    with pytest.raises(pr.InvalidInput, match="expected in_process=True"):
        pr.run("own.toml", processes={"early": own.early})
    with pytest.raises(pr.InvalidInput, match="early: expected a process"):
        pr.run("own.toml", in_process=True, processes={"early": own.steer})
    with pytest.raises(pr.InvalidInput, match="first"):
        pr.run("own.toml", in_process=True, processes={"first": own.early})
    # Without its writer a reader is refused, by the answer of the program.
    lines = SCENARIO.replace('"own.py", "early"', '"own.py", "later"').replace('"later"\ncommand', '"other"\ncommand')
    Path("own.toml").write_text(lines)
    with pytest.raises(pr.InvalidInput, match="reads own/early, but no process writes it"):
        pr.run("own.toml", allow_external=True)
    Path("own.py").write_text("print('hello')")
    with pytest.raises(pr.InvalidInput, match="process .*: it does not state its declaration: its answer is no JSON"):
        pr.run("own.toml", allow_external=True)
