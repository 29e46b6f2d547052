"""What people look at: views of a notebook, plots, films, rendered environments."""

import re
import shutil
import sys
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import protean_robotics as pr

EXPERIMENT = """
scenario = "builtin:hello"
seeds = { first = 1, count = 2 }
[parameters.limit]
title = "Time limit (s)"
set = "rules.time_limit"
[grid]
limit = [1, 25]
"""


@pytest.fixture
def chase(chase_log: Path) -> pr.Log:
    return pr.Log(chase_log)


@pytest.fixture
def sweep(tmp_path: Path) -> pr.Sweep:
    experiment = tmp_path / "limits.toml"
    experiment.write_text(EXPERIMENT)
    return pr.sweep(experiment, in_process=True, quiet=True)


def a_plan() -> Any:
    return pr.trajectory.plan(
        (0, 0, 0), (3, 0), discs=[(1.5, 0, 0.3)], polygons=[[(0, 1), (1, 1), (1, 2)]], clearance=0.1,
        bounds=[(-5, -5), (5, 5)], v_max=0.5, omega_max=2,
    )  # fmt: skip


class Balanced(HTMLParser):
    """Checks that elements are closed."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: Any) -> None:
        if tag != "img":
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: Any) -> None:
        pass

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_views_are_small_and_complete_in_themselves(chase: pr.Log, sweep: pr.Sweep) -> None:
    grid = np.zeros((30, 40), dtype=bool)
    grid[10:20, 5] = True
    run = pr.run("hello", seed=1, in_process=True)
    shown: dict[str, tuple[Any, str]] = {
        "run": (run, "escaped"),
        "sweep": (sweep, "data:image/svg+xml;base64,"),
        "topic": (chase["world/state"], "robots.x"),
        "robots": (chase.robots, "omega"),
        "map": (pr.Map.from_grid(grid, 0.1), "Map of 4 m × 3 m"),
        "large map": (pr.Map.from_grid(np.zeros((2000, 3000), dtype=bool), 0.01), "3000 × 2000 cells"),
        "plan": (a_plan(), "Trajectory of 6."),
    }
    for name, (value, text) in shown.items():
        view: str = value._repr_html_()
        assert text in view, name
        assert len(view) < 200_000, name
        parser = Balanced()
        parser.feed(view)
        assert parser.open == [], name
        # Only the name of the language of drawings.
        assert set(re.findall(r"https?://[^\"']*", view)) <= {"http://www.w3.org/2000/svg"}, name
        assert "<script" not in view, name
    logged = pr.run("hello", seed=1, in_process=True, out="hello.mcap")
    assert logged._repr_html_() == logged.log._repr_html_()


def test_a_view_shows_markup_in_names_as_text() -> None:
    from protean_robotics import _views

    text = "<b onclick='x'>&"
    for view in (_views.block(text), _views.table([text], [[text]]), _views.note(text)):
        assert text not in view and "&lt;b onclick=" in view


def test_a_map_shows_its_cells_with_y_upwards() -> None:
    image = pytest.importorskip("PIL.Image")
    import base64
    import io

    grid = np.zeros((20, 30), dtype=bool)
    grid[0, :10] = True
    view: str = pr.Map.from_grid(grid, 0.1)._repr_html_()
    data = re.search(r"data:image/png;base64,([^\"]*)", view)
    assert data is not None
    pixels = np.asarray(image.open(io.BytesIO(base64.b64decode(data[1]))))
    assert pixels.shape == (20, 30, 3)
    np.testing.assert_array_equal((pixels < 255).any(axis=2), grid[::-1])


def test_short_tables_have_words_and_the_values_of_the_messages(chase: pr.Log) -> None:
    short, full = chase.robots, chase["world/state"]
    assert short.columns == ["t", "name", "x", "y", "theta", "v", "omega", "status"]
    for name in ("x", "y", "theta", "v", "omega"):
        assert short[name] is short[name] and np.shares_memory(short[name], full[f"robots.{name}"])
    np.testing.assert_array_equal(short["t"], full["log_time_ns"] * 1e-9)
    last = {name: status for name, status in zip(short["name"], short["status"], strict=True)}
    assert last == chase.outcome
    ends: list[tuple[dict[str, Any], str, str]] = [
        ({"rules.time_limit": 1}, "hello", "timed_out"),
        ({}, "hello", "escaped"),
    ]
    for number, (changes, scenario, outcome) in enumerate(ends):
        run = pr.run(scenario, seed=1, in_process=True, set=changes, out=f"{number}.mcap")
        assert run.log.robots["status"][-1] == outcome


def test_tables_are_streams_of_arrow(chase: pr.Log, sweep: pr.Sweep) -> None:
    arrow = pytest.importorskip("pyarrow")
    pandas = pytest.importorskip("pandas")
    polars = pytest.importorskip("polars")
    topic = chase["world/state"]
    read = arrow.table(topic)
    assert read["robots.x"].chunk(0).buffers()[1].address == topic["robots.x"].ctypes.data
    for table in (topic, chase.robots, sweep):
        rows = arrow.table(table).num_rows
        assert len(pandas.DataFrame.from_arrow(table)) == polars.DataFrame(table).height == rows > 0
    assert sweep.to_pandas()["seed"].tolist() == sweep.to_polars()["seed"].to_list() == [1, 2, 1, 2]
    assert list(sweep.to_pandas().columns) == sweep.to_arrow().column_names
    duckdb = pytest.importorskip("duckdb")
    robots = chase.robots
    count = duckdb.sql("SELECT count(DISTINCT name) FROM robots").fetchall()
    assert robots is not None and count == [(len(chase.outcome),)]


def test_objects_draw_into_axes(chase: pr.Log, sweep: pr.Sweep) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    run = pr.run("hello", seed=1, in_process=True, out="hello.mcap")
    for draw in (chase.plot, run.plot, sweep.plot, pr.Map("hello").plot, a_plan().plot):
        _, ax = pyplot.subplots()
        assert draw(ax=ax) is ax
        assert ax.has_data() and ax.get_xlabel()
        assert draw().figure is not ax.figure
        ax.figure.savefig("figure.pdf")
        pyplot.close("all")
        with pytest.raises(pr.InvalidInput, match="expected axes of matplotlib"):
            draw(ax=3)
    ax = chase.plot("belief error")
    assert ax.get_title().startswith("Belief error") and ax.get_ylabel() == "m"
    assert [line.get_label() for line in ax.get_lines()] == ["evader_1", "evader_2"]
    belief = chase["perception/belief"]
    times = ax.get_lines()[0].get_xdata()
    assert times[-1] == pytest.approx(belief["log_time_ns"][-1] * 1e-9)
    with pytest.raises(pr.InvalidInput, match=r"quantity = 'colour': expected a part of one of: .*Forward speed"):
        chase.plot("colour")
    with pytest.raises(pr.InvalidInput, match="figure = 'no': expected one of outcome"):
        sweep.plot("no")
    with pytest.raises(pr.InvalidInput, match="the run has no log: expected out=PATH"):
        pr.run("hello", seed=1, in_process=True).plot()
    # The trails are those of the states.
    lines = chase.plot().get_lines()
    states = chase.robots
    own = states["name"] == "police_1"
    drawn = next(line for line in lines if line.get_label() == "police_1")
    np.testing.assert_array_equal(drawn.get_ydata(), states["y"][own])


def test_a_missing_package_is_named_with_its_extra(chase: pr.Log, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("matplotlib", "matplotlib.pyplot", "PIL", "PIL.Image"):
        monkeypatch.setitem(sys.modules, module, None)
    for draw in (chase.plot, lambda: chase.plot("belief error"), pr.Map("hello").plot, a_plan().plot):
        with pytest.raises(ImportError, match=r"matplotlib is missing: pip install 'protean-robotics\[plot\]'"):
            draw()
    with pytest.raises(ImportError, match=r"PIL is missing: pip install 'protean-robotics\[plot\]'"):
        chase.animate(fps=1)
    assert not list(Path.cwd().iterdir()) and chase._repr_html_().startswith("<iframe")


def test_pictures_have_the_format_of_their_ending(chase: pr.Log, tmp_path: Path) -> None:
    starts = {"svg": b"<svg", "png": b"\x89PNG", "pdf": b"%PDF", "PNG": b"\x89PNG"}
    for ending, start in starts.items():
        assert chase.picture(tmp_path / f"end.{ending}", at=1.0).read_bytes().startswith(start)
    with pytest.raises(pr.InvalidInput, match="pictures are SVG, PNG or PDF files"):
        chase.picture(tmp_path / "end.gif")


def test_frames_have_one_size_and_show_the_run(chase: pr.Log) -> None:
    frames = list(chase.frames(fps=2, speed=2))
    assert len(frames) == 3
    assert {(frame.shape, str(frame.dtype)) for frame in frames} == {(frames[0].shape, "uint8")}
    assert frames[0].shape[0] % 2 == frames[0].shape[1] % 2 == 0
    assert (frames[0] != frames[1]).any() and (frames[-1] != frames[1]).any()
    assert next(iter(chase.frames(size=(320, 200)))).shape == (200, 320, 3)
    for wrong in ({"fps": 0}, {"speed": float("nan")}, {"size": 3}, {"size": (0, 5)}, {"fps": 1e9}, {"fps": "many"}):
        with pytest.raises(pr.InvalidInput, match=f"{next(iter(wrong))} = .*expected"):
            chase.frames(**wrong)  # type: ignore[arg-type]


def test_a_run_is_filmed(chase: pr.Log, tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    film = chase.animate(tmp_path / "chase.gif", fps=2, size=(160, 120))
    with image.open(film) as opened:
        assert (opened.size, opened.n_frames, opened.info["duration"]) == ((160, 120), 5, 500)
    with pytest.raises(pr.InvalidInput, match="exists already"):
        chase.animate(film)
    assert chase.animate(film, fps=1, size=(160, 120), force=True) == film
    with pytest.raises(pr.InvalidInput, match=r"films are GIF or MP4 files: .*for example .*a\.gif"):
        chase.animate(tmp_path / "a.avi")
    with pytest.raises(pr.Error, match="cannot be created"):
        chase.animate(tmp_path / "no" / "a.gif")
    if shutil.which("ffmpeg"):
        data = chase.animate(tmp_path / "chase.mp4", fps=2, size=(161, 121)).read_bytes()
        assert data[4:8] == b"ftyp"
    assert {path.suffix for path in tmp_path.iterdir()} <= {".gif", ".mp4"}


def test_environments_are_drawn() -> None:
    pytest.importorskip("gymnasium")
    env = pr.Env("hello", agents=["robot"], render_mode="rgb_array")
    with pytest.raises(pr.Error, match="are not reset"):
        env.render()
    env.reset(seed=1)
    first = env.render()
    assert first is not None and first.dtype == np.uint8 and first.shape[2] == 3
    assert env.metadata["render_modes"] == ["rgb_array"] and env.metadata["render_fps"] == 20
    for _ in range(40):
        env.step(np.ones(2, dtype=np.float32))
    later = env.render()
    assert later is not None and later.shape == first.shape and (later != first).any()
    # A new episode has no trail of the last one.
    env.reset(seed=1)
    np.testing.assert_array_equal(env.render(), first)
    for threads in (1, 2):
        envs = pr.VectorEnv("hello", 2, agents=["robot"], seed=1, threads=threads, render_mode="rgb_array")
        envs.reset()
        frames = envs.render()
        assert frames is not None and [frame.shape for frame in frames] == [first.shape] * 2
        envs.close()
    assert pr.Env("hello", agents=["robot"]).render() is None
    for mode in ("human", 3):
        with pytest.raises(pr.InvalidInput, match=r"render_mode = .*: expected None or 'rgb_array'"):
            pr.Env("hello", agents=["robot"], render_mode=mode)  # type: ignore[arg-type]
    pytest.importorskip("pettingzoo")
    parallel = pr.parallel_env("chase_exact", agents=["evader"], render_mode="rgb_array")
    parallel.reset(seed=1)
    frame = parallel.render()
    assert frame is not None and frame.shape[2] == 3 and parallel.render_mode == "rgb_array"


def test_processes_and_obstacles_are_drawn_with_the_learner() -> None:
    """With processes of the scenario the world is in another thread; obstacles appear in the picture."""
    pytest.importorskip("gymnasium")
    soon = {f"events.{i}.when.progress": 0.02 for i in range(2)}
    env = pr.Env("popup", agents=["scout"], render_mode="rgb_array", set=soon)
    env.reset(seed=1)
    before = env.render()
    for _ in range(200):
        env.step(np.array([1.0, 0.0], dtype=np.float32))
    after = env.render()
    assert before is not None and after is not None
    orange = (np.array([0xE6, 0x9F, 0x00]) - after.astype(int)).__abs__().max(axis=2) < 3
    assert orange.sum() > 100


def test_wrappers_of_gymnasium_record_films(tmp_path: Path) -> None:
    gymnasium = pytest.importorskip("gymnasium")
    from gymnasium.wrappers import AddRenderObservation, RenderCollection
    from gymnasium.wrappers import vector as wrappers

    env = RenderCollection(pr.Env("hello", agents=["robot"], render_mode="rgb_array"))
    env.reset(seed=1)
    for _ in range(3):
        env.step(env.action_space.sample())
    frames: Any = env.render()
    assert len(frames) == 4
    seen = AddRenderObservation(pr.Env("hello", agents=["robot"], render_mode="rgb_array"), render_only=True)
    observation, _ = seen.reset(seed=1)
    assert observation in seen.observation_space
    pytest.importorskip("moviepy")
    single = gymnasium.wrappers.RecordVideo(
        pr.Env("hello", agents=["robot"], render_mode="rgb_array"), str(tmp_path / "single"), video_length=3
    )
    single.reset(seed=1)
    for _ in range(4):
        single.step(single.action_space.sample())
    single.close()
    many = wrappers.RecordVideo(
        pr.VectorEnv("hello", 4, agents=["robot"], autoreset_mode="NextStep", render_mode="rgb_array"),
        str(tmp_path / "many"),
        video_length=3,
    )
    many.reset(seed=1)
    for _ in range(4):
        many.step(many.action_space.sample())
    many.close()
    for folder in ("single", "many"):
        (film,) = (tmp_path / folder).glob("*.mp4")
        assert film.read_bytes()[4:8] == b"ftyp"
