"""The numbers of the report on motion camouflage: verdicts follow from them, and the page is what it was."""

from pathlib import Path

import pytest

pytest.importorskip("jinja2")
pytest.importorskip("scipy")

from protean_robotics.lab.claim import Verdict
from protean_robotics.lab.vmc_lp.claims import claims
from protean_robotics.lab.vmc_lp.evidence import TABLE_2, Evidence, Plan, Study
from protean_robotics.lab.vmc_lp.page import build

CONFIRMED, REFUTED, UNDECIDED, NO_DATA = Verdict
SENSITIVITY, VERSUS = "vmc_lp_sensitivity", "vmc_lp_tables_3_4"


def plans(count: int, failed: int, time: float, cpu_ms: float = 2.0) -> dict[int, Plan]:
    return {seed: Plan(False, time if seed >= failed else None, cpu_ms) for seed in range(count)}


def sensitivity(**cells: tuple[int, float]) -> Evidence:
    """500 plans of VMC for some settings: number of failed ones, times of the others."""
    return Evidence({SENSITIVITY: Study(cells={("vmc", value): plans(500, *of) for value, of in cells.items()})})


def line(text: str, start: str) -> str:
    return next(line for line in text.splitlines() if line.startswith(start))


def test_without_results_the_page_has_notes() -> None:
    page = build(Evidence())
    assert not page.images and page.text.count("*No results of this experiment.*") == 2


def test_counts_are_compared_with_the_published_ones() -> None:
    page = build(
        sensitivity(
            radius_5_15=(3, 39.0), radius_20_30=(4, 39.0), obstacles_1_10=(3, 38.0), obstacles_30_40=(60, 38.0)
        )
    )
    assert "does not contradict" in line(page.text, "| radius | 5 … 15 px | 6/500 | 3/500 |")
    assert "fewer fail here" in line(page.text, "| radius | 20 … 30 px | 125/500 | 4/500 |")
    assert "hardly matters" in line(page.text, "| radius | sensitive | +23.8 | +0.2 |")
    assert "confirmed" in line(page.text, "| obstacles | sensitive | +9.8 | +11.4 |")
    assert "no results" in line(page.text, "| nodes | 10 | 20/500 | – |")
    assert len(page.images) == 1


def test_settings_of_one_set_of_runs_are_counted_once() -> None:
    same = (15, 39.0)
    text = build(sensitivity(degree_4=same, nodes_15=same, radius_5_15=same, degree_6=(5, 38.0))).text
    # 15 of 500 against 2 of 500 and 6 of 500 (twice): Fisher's test of 15/500 and 8/1000 gives 0.00266, Holm's
    # correction over two tests, 15/500 and 5/500, doubles it.
    row = "| degree<br>nodes<br>radius | 4<br>15<br>5 … 15 px | 2/500<br>6/500<br>6/500 | 15/500 |"
    assert line(text, row).endswith("more fail here | p = 0.0053 |")
    assert "| nodes | 15 | 6/500 | 15/500" not in text
    # 10 seeds fail with degree 4 alone: 2 / 2¹⁰ by McNemar's exact test.
    row = line(text, "| degree | less sensitive | +0.6 | −2.0 | ")
    assert "| 10, 0 |" in row and row.endswith("p = 0.0020 |")


def test_methods_are_compared_where_both_have_a_plan() -> None:
    cells = {
        (case, horizon): plans(100, failed, time, cpu)
        for horizon in ("only", "first", "second")
        for case, failed, time, cpu in (("lp", 10, 30.0, 1.0), ("vmc", 0, 30.03, 3.0))
    }
    text = build(Evidence({VERSUS: Study(cells=cells)})).text
    assert "| 90, 100 of 100 | 30.00, 30.03 | 90/90 " in text
    assert "shorter more often than VMC's: confirmed (ours 270/270" in text
    assert "of the time in most tests: **contradicted** (ours 0/270" in text
    # The published tables alone.
    assert "(Table 3), published | 6, 6 of 6 | 34.65, 35.62 | 5/6 " in text


def made_up() -> Evidence:
    """Synthetic results of both experiments: every setting, method and horizon of the page."""

    def cell(failed: int, time: float, cpu_ms: float) -> dict[int, Plan]:
        def plan(seed: int) -> Plan:
            found = time + 0.01 * (seed % 7) if seed % 100 >= failed else None
            return Plan(seed % 97 == 0, found, cpu_ms + 0.1 * (seed % 5))

        return {seed: plan(seed) for seed in range(1, 201)}

    settings = [setting.name for row in TABLE_2 for setting in row.settings]
    counts = {"vmc": 0, "vmc_nodes": 9, "lp": 1, "lp_nodes": 20}
    first = {
        (case, name): cell(index * 5 % 13 + more, 39.0, 2.0)
        for index, name in enumerate(settings)
        for case, more in counts.items()
    }
    second = {}
    for index, horizon in enumerate(("only", "first", "second")):
        second["lp", horizon] = cell(0, 30.0, 1.0)
        second["vmc", horizon] = cell(2, 30.001 + 0.1 * index, 3.0)
        second["lp_paper", horizon] = cell(1, 30.02, 1.0 + index)
        second["vmc_paper", horizon] = cell(4, 29.9, 1.5)
    return Evidence({SENSITIVITY: Study("0.1.0", "1..200", first), VERSUS: Study("0.1.0", "1..200", second)})


def test_the_page_is_what_it_was() -> None:
    page = build(made_up())
    assert page.text == Path(__file__).with_name("lab").joinpath("vmc_lp.md").read_text()
    assert [image.name for image in page.images] == ["vmc-lp-sensitivity", "vmc-lp-cpu"]


def test_counts_changes_and_observations_are_claims() -> None:
    evidence = sensitivity(radius_5_15=(3, 39.0), radius_20_30=(4, 38.0))
    cells = {(case, "only"): plans(20, 0, time, time) for case, time in (("lp", 30.0), ("vmc", 31.0))}
    evidence.studies[VERSUS] = Study(cells=cells)
    found = claims(evidence)
    by_id = {claim.id: claim for claim in found}
    for key, expected in {
        "table2.vmc.radius_5_15": CONFIRMED,
        "table2.vmc.radius_20_30": REFUTED,
        "table2.vmc.degree_6": NO_DATA,
        "table2.vmc.radius.change": REFUTED,
        "tables34.recommended.shorter": CONFIRMED,
        "tables34.recommended.quicker": CONFIRMED,
        "tables34.as_published.quicker": NO_DATA,
    }.items():
        assert by_id[f"vmc-lp.{key}"].verdict == expected, by_id[f"vmc-lp.{key}"]
    small = by_id["vmc-lp.table2.vmc.radius_5_15"]
    assert (small.published.text, small.ours.text, small.ours.n) == ("6/500", "3/500", 500)
    assert {claim.id.rpartition(".")[2] for claim in found if claim.timed} == {"quicker"}
    assert len(claims(Evidence())) == 2
