"""Logs as arrays, beside independent readers."""

import re
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import protean_robotics as pr


@pytest.fixture
def chase(chase_log: Path) -> pr.Log:
    return pr.Log(chase_log)


def messages(log: Path, topic: str) -> list[Any]:
    """Messages of a topic, decoded by mcap-ros2-support."""
    reader = pytest.importorskip("mcap_ros2.reader")
    return [message for message in reader.read_ros2_messages(str(log), topics=[topic])]


def test_a_log_states_its_run(chase: pr.Log, chase_log: Path) -> None:
    assert (chase.path, chase.scenario, chase.seed) == (chase_log, "chase", 7)
    assert set(chase.outcome.values()) <= {"active", "caught", "escaped", "timed_out"}
    assert "police_1" in chase.outcome
    assert chase.digest is not None and len(chase.digest) == 64
    assert chase.faults == []
    assert repr(chase).startswith(f"<Log {chase_log}: chase, seed 7, 2.00 s, ")
    assert chase.digest in str(chase)


def test_a_log_counts_the_simulated_messages_as_its_run(tmp_path: Path) -> None:
    run = pr.run("hello", seed=1, in_process=True, out=tmp_path / "hello.mcap")
    count = run.log.info["simulated_messages"]
    assert count == run.summary["simulated_messages"] > 0
    assert f"messages    {count} simulated" in str(run.log)


def test_topics_are_counted_as_by_mcap(chase: pr.Log, chase_log: Path) -> None:
    reader = pytest.importorskip("mcap.reader")
    with chase_log.open("rb") as file:
        summary = reader.make_reader(file).get_summary()
    counts = summary.statistics.channel_message_counts
    expected = {channel.topic: counts[id] for id, channel in summary.channels.items() if id in counts}
    assert chase.topics == {topic: count for topic, count in expected.items() if count}
    assert list(chase) == list(chase.topics) and "world/state" in chase and "nope" not in chase
    with pytest.raises(KeyError, match="nope: no topic of the log has this name: expected one of .*world/state"):
        chase["nope"]


@pytest.mark.parametrize(
    ("topic", "element"),
    [("world/state", "robots"), ("perception/belief", "particles"), ("perception/sighting", "sightings")],
)
def test_columns_have_the_values_that_another_reader_sees(chase_log: Path, topic: str, element: str) -> None:
    columns = pr.Log(chase_log)[topic].to_numpy()
    expected: dict[str, list[Any]] = {}

    def add(name: str, value: Any) -> None:
        if hasattr(value, "__slots__"):
            for field in value.__slots__:
                add(f"{name}.{field}" if name else field, getattr(value, field))
        elif isinstance(value, (bool, int, float)):
            expected.setdefault(name, []).append(value)

    for message in messages(chase_log, topic):
        elements = getattr(message.ros_msg, element)
        for index, of_element in enumerate(elements):
            expected.setdefault("log_time_ns", []).append(message.log_time_ns)
            add(f"{element}.index", index)
            add("", message.ros_msg)
            add(element, of_element)
    assert len(expected) > 10
    for name, values in expected.items():
        found = columns[name]
        if found.dtype.kind == "f":
            values = np.array(values, dtype=found.dtype).tolist()
        np.testing.assert_array_equal(found, np.array(values, dtype=found.dtype), err_msg=name)


def test_arrays_are_typed_decoded_once_and_not_to_be_written(chase: pr.Log) -> None:
    topic = chase["world/state"]
    columns = topic.to_numpy()
    assert topic.columns == list(columns) and topic.undecodable == 0
    assert {len(values) for values in columns.values()} == {len(columns["robots.x"])}
    dtypes = {name: str(columns[name].dtype) for name in ("log_time_ns", "robots.x", "robots.robot_name")}
    assert dtypes == {"log_time_ns": "uint64", "robots.x": "float64", "robots.robot_name": "object"}
    assert chase["world/state"]["robots.x"] is columns["robots.x"]
    for values in columns.values():
        with pytest.raises(ValueError, match="read-only"):
            values[0] = values[0]
    with pytest.raises(KeyError, match="world/state has no column x; it has log_time_ns"):
        topic["x"]


def test_rows_without_elements_are_masked(chase: pr.Log) -> None:
    events = chase["world/event"].to_numpy()
    kinds = events["events.kind"]
    count = kinds.compressed().size if isinstance(kinds, np.ma.MaskedArray) else kinds.size
    assert count == len(chase.events)


def test_events_are_those_of_the_summary(chase: pr.Log) -> None:
    assert chase.events and chase.events[-1]["kind"] == "game_over"
    times = [event["time_s"] for event in chase.events]
    assert times == sorted(times)
    timed_out = [event for event in chase.events if event["kind"] == "timed_out"]
    assert {event["robot"] for event in timed_out} <= set(chase.outcome)


def test_tables_of_arrow_share_the_memory_of_the_arrays(chase: pr.Log) -> None:
    pytest.importorskip("pyarrow")
    topic = chase["world/state"]
    table, arrays = topic.to_arrow(), topic.to_numpy()
    assert table.column_names == list(arrays)
    x = table["robots.x"].chunk(0)
    assert x.buffers()[1].address == arrays["robots.x"].ctypes.data
    assert table["robots.robot_name"].to_pylist() == list(arrays["robots.robot_name"])


def test_data_frames_have_the_values_of_the_arrays(chase: pr.Log) -> None:
    pytest.importorskip("pyarrow")
    topic = chase["world/event"]
    arrays = topic.to_numpy()
    frames: list[Any] = []
    if pytest.importorskip("pandas"):
        frames.append(topic.to_pandas())
    if pytest.importorskip("polars"):
        frames.append(topic.to_polars())
    for frame in frames:
        assert list(frame.columns) == list(arrays)
        assert list(frame["stamp.tick"]) == list(arrays["stamp.tick"])
        assert list(frame["events.kind"].is_null() if hasattr(frame, "lazy") else frame["events.kind"].isna()) == list(
            np.ma.getmaskarray(arrays["events.kind"])
        )


def test_without_pyarrow_the_error_names_the_extra(chase: pr.Log, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ImportError, match=r"pip install 'protean-robotics\[arrow\]'"):
        chase["world/state"].to_arrow()


def test_a_cut_log_is_read_as_far_as_it_goes(chase_log: Path, tmp_path: Path) -> None:
    whole = chase_log.read_bytes()
    path = tmp_path / "cut.mcap"
    path.write_bytes(whole[: len(whole) * 2 // 3])
    cut, log = pr.Log(path), pr.Log(chase_log)
    assert cut.faults and cut.digest is None and cut.outcome == {}
    assert "incomplete" in repr(cut)
    part, all_of_it = cut["world/state"]["robots.x"], log["world/state"]["robots.x"]
    assert 0 < len(part) < len(all_of_it)
    np.testing.assert_array_equal(part, all_of_it[: len(part)])


def test_what_is_no_log_is_refused_as_by_the_command(tmp_path: Path) -> None:
    missing = tmp_path / "missing.mcap"
    with pytest.raises(pr.InvalidInput, match=f"{missing}: cannot be read: No such file"):
        pr.Log(missing)
    other = tmp_path / "other.mcap"
    other.write_text("no log at all")
    with pytest.raises(pr.InvalidInput, match=f"{other} is not an MCAP file"):
        pr.Log(str(other))


def test_logs_of_other_programs_have_topics_but_no_run(tmp_path: Path) -> None:
    writer = pytest.importorskip("mcap.writer")
    path = tmp_path / "other.mcap"
    with path.open("wb") as file:
        log = writer.Writer(file)
        log.start()
        schema = log.register_schema("P", "ros2msg", b"int16 a\nfloat64[] v")
        points = log.register_channel("p", "cdr", schema)
        notes = log.register_channel("note", "json", log.register_schema("N", "jsonschema", b"{}"))
        data = bytes([0, 1, 0, 0]) + np.array([-3, 0, 2, 0], "<i2").tobytes() + np.array([0.5, 2.5]).tobytes()
        for t in (7, 9):
            log.add_message(points, t, data, t)
        log.add_message(points, 10, b"?", 10)
        log.add_message(notes, 8, b"{}", 8)
        log.finish()
    other = pr.Log(path)
    assert (other.scenario, other.seed, other.digest, other.outcome) == (None, None, None, {})
    assert other.topics == {"note": 1, "p": 3} and other.events == []
    expected: dict[str, NDArray[Any]] = {
        "log_time_ns": np.array([7, 7, 9, 9], np.uint64),
        "a": np.full(4, -3, np.int64),
        "v": np.array([0.5, 2.5, 0.5, 2.5]),
    }
    for name, values in expected.items():
        np.testing.assert_array_equal(other["p"][name], values, strict=True)
    assert other["p"].undecodable == 1
    with pytest.raises(pr.InvalidInput, match="note: its encoding is `json`"):
        other["note"].to_numpy()
    with pytest.raises(pr.InvalidInput, match="not a Protean log"):
        other.report()
    assert other._repr_html_().startswith("<pre>")


def test_a_log_is_its_report_in_a_notebook(chase: pr.Log, tmp_path: Path) -> None:
    shown = chase._repr_html_()
    assert shown.startswith('<iframe srcdoc="') and shown.endswith("</iframe>")
    page = chase.report(tmp_path / "page.html").read_text()
    start, end = len('<iframe srcdoc="'), shown.rindex('" style=')
    assert '"' not in shown[start:end] and page.count("<script") == shown.count("&lt;script")
    with pytest.raises(pr.InvalidInput, match="exists already"):
        chase.report(tmp_path / "page.html")
    chase.report(tmp_path / "page.html", force=True)


def test_pictures_are_drawn(chase: pr.Log, tmp_path: Path) -> None:
    assert chase.picture(tmp_path / "end.svg", at=1.0).read_text().startswith("<svg")
    with pytest.raises(pr.InvalidInput, match="pictures are SVG, PNG or PDF files"):
        chase.picture(tmp_path / "end.gif")
    with pytest.raises(pr.InvalidInput, match="99"):
        chase.picture(tmp_path / "late.svg", at=99.0)


def test_other_threads_run_while_a_log_is_read(chase_log: Path) -> None:
    counted = 0
    reading = threading.Event()

    def count() -> None:
        nonlocal counted
        while not reading.is_set():
            counted += 1
            time.sleep(0.0001)

    thread = threading.Thread(target=count)
    thread.start()
    for _ in range(3):
        pr.Log(chase_log)["perception/belief"].to_numpy()
    reading.set()
    thread.join()
    assert counted > 10


def test_the_code_of_the_guide_runs(chase_log: Path) -> None:
    for module in ("matplotlib", "pandas", "polars", "pyarrow"):
        pytest.importorskip(module)
    guide = Path(__file__).parents[2] / "docs/how-to/python-logs.md"
    blocks = re.findall(r"^```python\n(.*?)^```", guide.read_text(), re.DOTALL | re.MULTILINE)
    assert len(blocks) == 8
    subprocess.run([sys.executable, "-c", "\n".join(blocks)], cwd=chase_log.parent, check=True, timeout=120)


def test_the_idleness_of_patrols_is_a_table(tmp_path: Path, chase: pr.Log) -> None:
    run = pr.run("patrol_team", seed=1, set={"rules.time_limit": 60}, in_process=True, out=tmp_path / "team.mcap")
    patrols = run.log.patrols
    assert len(patrols["log_time_ns"]) == run.log.topics["world/state"]
    assert set(patrols["robots"]) == {"guard_1, guard_2, guard_3, guard_4"}
    mean, worst, visited = (patrols[name] for name in ("mean_idleness_s", "worst_idleness_s", "visited"))
    t = patrols["log_time_ns"] * 1e-9
    assert np.all(mean <= worst) and np.all(worst <= t + 1e-9) and np.all(np.diff(visited) >= 0)
    # Before any visit of its place, the maximum is the time of the run.
    assert np.all(worst[visited < 1] == pytest.approx(t[visited < 1]))
    # Without a patrol it has no rows.
    assert chase.patrols.columns == patrols.columns and len(chase.patrols["visited"]) == 0
