"""The reports on all claims, pages and plans as files, and the experiments of the package."""

import json
import tomllib
from pathlib import Path

import pytest

jinja2 = pytest.importorskip("jinja2")
pytest.importorskip("matplotlib")
pytest.importorskip("scipy")

import protean_robotics as pr
from protean_robotics.lab import figures, page, plans
from protean_robotics.lab.claim import ONE_RUN, SPEED, Claim, Finding, Measured, Paper, Published, Verdict, number
from protean_robotics.lab.evidence import Evidence
from protean_robotics.lab.experiments import EXPERIMENTS
from protean_robotics.lab.plans import Plan
from protean_robotics.lab.report import Ran, Report
from protean_robotics.lab.results import Cell, Results
from protean_robotics.lab.statistics import Interval

ROOT = Path(__file__).parents[2]


def report() -> Report:
    metres = number(2, "m")
    finding = Finding.one_run(2.0, [1.0, 1.5, 1.5, 1.5, 2.0], metres, "keys")
    exact = Claim(Paper.PATROL, "a|b", "a | <b>", Published.number(2.0, metres), ONE_RUN, finding)
    ours = Measured("above 1.2×", None, Interval(1.2, float("inf")), SPEED, 3, "games")
    refuted = Finding(Verdict.REFUTED, ours, ["p < 0.0001"])
    timed = Claim(Paper.CHASE, "c", "quick", Published("often"), "a rule", refuted, timed=True)
    chart = figures.Chart("curve", "x", "y", [figures.Series("one", [figures.Point(0.0, 0.5)])])
    pages = {"chase.md": page.Page("text\n", [chart])}
    return Report([Paper.PATROL, Paper.CHASE], [Ran("patrol_alpha", "1..3", 6, 1)], [exact, timed], pages, "0.0.0")


def test_the_table_has_a_row_for_every_claim() -> None:
    lines = report().markdown().splitlines()
    for row in (
        "| patrol | a \\| <b> | 2.00 m | 1.50 m | 0.42 … 2.58 | 5 keys | **confirmed** |",
        "| chase | quick † | often | above 1.2× | above 1.2× | 3 games | **refuted** |",
        "| patrol | Cat-map patrol paper | 1 | 0 | 0 | 0 |",
        "| `patrol_alpha` | 1..3 | 6 | 1 |",
        "- From `chase.c` on: a rule",
    ):
        assert row in lines, row


def test_the_same_numbers_are_data() -> None:
    data = json.loads(report().json())
    exact, timed = data["claims"]
    assert (exact["paper"], exact["id"], exact["published"]["value"]) == ("patrol", "patrol.a|b", 2.0)
    assert (exact["ours"]["unit"], exact["verdict"]) == ("m", "confirmed")
    # s = √0.125, t with 4 degrees of freedom 2.77645: 1.5 − 2.77645 s √(1 + 1/5).
    assert exact["ours"]["interval"][0] == pytest.approx(1.5 - 1.075_313, abs=1e-5)
    assert timed["ours"]["interval"] == [1.2, None] and timed["timed"] is True
    assert data["papers"][1]["verdicts"] == {"confirmed": 0, "refuted": 1, "undecided": 0, "no_data": 0}


def test_the_page_escapes_texts_and_has_the_figures() -> None:
    html = report().html()
    assert "a | &lt;b&gt;" in html and "<b>" not in html and "<li>p &lt; 0.0001</li>" in html
    assert html.endswith("</html>\n") and "{{" not in html and html.count("data:image/svg+xml") == 1


def test_reports_and_pages_are_files_with_the_same_bytes_each_time() -> None:
    out = Path("out")
    written = report().write(out)
    names = ["reproduce.md", "reproduce.json", "reproduce.html", "pages/images/curve.svg", "pages/chase.md"]
    assert written == [out / name for name in names]
    before = [path.read_bytes() for path in written]
    assert [path.read_bytes() for path in report().write(out)] == before
    # Nothing half-written beside them.
    assert sorted(path for path in out.rglob("*") if path.is_file()) == sorted(written)


def test_pages_of_the_documentation_are_those_of_the_templates() -> None:
    templates = Path(page.__file__).with_name("templates")
    for template in sorted(templates.glob("*.md")):
        lines = (ROOT / "docs/results" / template.name).read_text()
        assert lines.startswith(page.MARK)
        for line in template.read_text().splitlines():
            assert "{" in line or line in lines.splitlines(), line


def test_a_slot_without_a_value_is_an_error() -> None:
    with pytest.raises(jinja2.UndefinedError, match="escape_vs_speed"):
        page.fill("chase.md", {"verdicts": ""})


def test_written_plans_are_read_back() -> None:
    found = Plan("rrt_star_line", "start", 2, 5000, True, 17.25, 1.5, 17.14, 0.1)
    lost = Plan("rrt_star_line", "random", 1, 5000, False, None, None, 17.14, 0.1)
    path = Path("plans.csv")
    path.write_bytes(plans.table([found, lost]))
    assert plans.read(path) == [lost, found] and plans.read(Path("none.csv")) == []
    path.write_text("case,seed\na,1\n")
    with pytest.raises(pr.InvalidInput, match="plans.csv:1: .*expected a table of plans"):
        plans.read(path)
    path.write_bytes(plans.table([found]).replace(b"true", b"maybe"))
    with pytest.raises(pr.InvalidInput, match="plans.csv:2: .*maybe.*expected a table of plans"):
        plans.read(path)


def test_the_same_seed_gives_the_same_plans() -> None:
    made = plans.make(1)
    assert len(made) == 8 and plans.make(1) == made
    line = made[0]
    assert (line.case, line.scene, line.found) == ("rrt_star_line", "start", True)
    # From its start to the exit; the start varies by 5 cm.
    assert line.shortest_m == pytest.approx(16.987, abs=0.15)
    assert line.length_m is not None and line.length_m >= line.shortest_m - 1e-6
    assert {plan.scene for plan in made} == {"start", "random"} and len({plan.case for plan in made}) == 4


def test_every_experiment_has_a_file_with_the_seeds_of_a_quick_reproduction() -> None:
    for experiment in EXPERIMENTS:
        found = tomllib.loads(experiment.file.read_text())
        assert found.get("name", experiment.name) == experiment.name
        assert found["seeds"].get("first", 1) == 1 and found["seeds"]["count"] >= experiment.quick


def test_results_of_other_experiments_are_refused() -> None:
    other = Results(Path("out"), "small", "", "", "1", (), (), {}, {})
    with pytest.raises(pr.InvalidInput, match="out contains .*`small`: expected one of escape_vs_speed"):
        Evidence().add(other)
    varied = Results(Path("out"), "knowledge", "", "", "1", ("noise",), (Cell("a", (1.0,)),), {}, {})
    with pytest.raises(pr.InvalidInput, match="varies .*noise.*: expected `relative_speed` alone"):
        Evidence().add(varied)
