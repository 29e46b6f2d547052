"""Figures of experiments, from their results."""

import json
import subprocess
import sys
import xml.etree.ElementTree
from pathlib import Path

import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("scipy")

import protean_robotics as pr
from protean_robotics.lab import figures, results

EXPERIMENT = """
scenario = "builtin:hello"
seeds = { first = 1, count = 2 }

[[cases]]
name = "plain"
title = "Plain"

[[cases]]
name = "shy_one"
set.defaults.robot.start_jitter = { x = 0.1, y = 0.1 }

[parameters.limit]
title = "time limit [s]"
set = "rules.time_limit"

[grid]
limit = [0.5, 1]
"""
COMPARED = """
[[figures]]
name = "length"
title = "Length of a game"
x = "limit"
metric = "game_time"
compare = "published/points.csv"
"""
POINTS = "series,x,y,low,high\nplain,0.5,0.6,0.3,0.8\nPlain,1,0.9,,\n"


def sweep(text: str, out: str = "out") -> pr.Sweep:
    Path("limits.toml").write_text(text)
    return pr.sweep("limits.toml", out=out, in_process=True, quiet=True)


def test_cells_become_points_with_published_ones() -> None:
    Path("published").mkdir()
    Path("published/points.csv").write_text(POINTS)
    done = sweep(EXPERIMENT + COMPARED)
    (chart,) = figures.charts(results.read(done.directory))
    assert (chart.name, chart.title, chart.share) == ("length", "Length of a game", False)
    assert (chart.x_label, chart.y_label) == ("time limit [s]", "length of a game [s]")
    assert chart.subtitle == "limits: 2 games per point"
    assert [series.name for series in chart.series] == ["Plain", "shy one"]
    for series in chart.series:
        assert [point[:2] for point in series.points] == [(0.5, 0.5), (1.0, 1.0)]
    assert chart.series[0].reference == [(0.5, 0.6, (0.3, 0.8)), (1.0, 0.9, None)]
    (file,) = figures.write(done.directory)
    assert file == done.directory / "figures/length.svg"
    page = xml.etree.ElementTree.parse(file)
    texts = {element.text for element in page.iter("{http://www.w3.org/2000/svg}text")}
    assert {"Plain", "shy one", "published", "Length of a game", "time limit [s]"} <= texts
    before = file.read_bytes()
    command = [str(pr.program()), "sweep", "figures", str(done.directory)]
    drawn = subprocess.run(command, capture_output=True, text=True, check=True)
    assert Path(drawn.stdout.strip()) == file and file.read_bytes() == before
    ax = done.plot("length")
    assert ax.get_ylabel() == "length of a game [s]"
    assert ax.get_legend_handles_labels()[1] == ["Plain", "shy one", "published"]
    assert done._repr_html_().count("data:image/svg+xml") == 1


def test_published_points_must_be_valid() -> None:
    Path("published").mkdir()
    Path("published/points.csv").write_text("series,x\na,1\n")
    done = sweep(EXPERIMENT + COMPARED)
    with pytest.raises(pr.InvalidInput, match=r"points.csv:2: .*expected the columns series, x, y"):
        figures.write(done.directory)


def test_without_figures_the_main_outcome_is_drawn_over_the_first_parameter_that_varies() -> None:
    (chart,) = figures.charts(results.read(sweep(EXPERIMENT).directory))
    assert (chart.name, chart.title) == ("outcome", "evaders that escape by time limit [s]")
    assert figures.charts(results.read(sweep("figures = []\n" + EXPERIMENT, "none").directory)) == []
    kinds = EXPERIMENT.replace("[0.5, 1]", "[1]")
    assert figures.charts(results.read(sweep(kinds, "one").directory)) == []


def test_a_metric_counts_evaders_of_games() -> None:
    def row(escaped: int) -> dict[str, object]:
        return {"outcome": "ended", "evaders": 2, "escaped": escaped, "sim_time_s": 12.5}

    cells = (results.Cell("a", ("slow",)), results.Cell("a", ("fast",)))
    rows = {(cell, seed): row(cell + 1) for cell in (0, 1) for seed in (1, 2, 3)} | {(0, 4): {"outcome": "failed"}}
    directory = Path("made")
    directory.mkdir()
    (directory / "experiment.toml").write_text('[[figures]]\nname = "chance"\nx = "speed"\n')
    found = results.Results(directory, "made", "Made", "", "1..4", ("speed",), cells, rows, {})
    (chart,) = figures.charts(found)
    assert (chart.title, chart.share, chart.x_names) == ("Made", True, ["slow", "fast"])
    assert [point[:2] for point in chart.series[0].points] == [(0.0, 0.5), (1.0, 1.0)]
    assert all(point.interval for point in chart.series[0].points)
    assert figures.svg(chart) == figures.svg(chart)


def test_every_metric_of_experiment_files_is_known() -> None:
    command = [str(pr.program()), "schema", "experiment"]
    schema = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    metrics = schema["definitions"]["Metric"]
    named = {name for part in metrics.get("oneOf", [metrics]) for name in part.get("enum", [part.get("const")])}
    assert named == set(figures.METRICS)


def test_directories_without_figures_are_refused() -> None:
    def refused(directory: str, *parts: str) -> None:
        command = [sys.executable, "-m", "protean_robotics.lab", "figures", directory]
        ended = subprocess.run(command, capture_output=True, text=True, check=False)
        assert ended.returncode == 2 and all(part in ended.stderr for part in ("error: ", *parts)), ended.stderr

    refused("nothing", "manifest.json", "expected the directory of the results of a sweep")
    Path("torn").mkdir()
    Path("torn/manifest.json").write_text("{}")
    refused("torn", "expected the manifest of a sweep")


def test_the_journal_gives_a_result_in_the_place_of_a_failure() -> None:
    done = sweep(EXPERIMENT)
    journal = done.directory / "journal.jsonl"
    lines = journal.read_text().splitlines(keepends=True)
    failed = json.loads(lines[0])
    failed["row"] |= {"outcome": "failed"}
    # The last line is torn, as after a kill.
    journal.write_text(json.dumps(failed) + "\n" + "".join(lines) + lines[0][:20])
    found = results.read(done.directory)
    assert len(found.rows) == 8 and found.failed == 0 and found.seeds == "1..2"
    journal.write_text(lines[0] + "{\n")
    with pytest.raises(pr.InvalidInput, match=r"journal.jsonl:2: .*expected the line as the sweep wrote it"):
        results.read(done.directory)
    assert results.seeds_text([1, 2, 3, 7, 9, 10]) == "1..3, 7, 9..10"
