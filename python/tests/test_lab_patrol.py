"""The numbers of the patrol and coverage papers: verdicts follow from them, and the page is what it was."""

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("jinja2")
pytest.importorskip("scipy")

from protean_robotics.lab.claim import Verdict
from protean_robotics.lab.page import Page
from protean_robotics.lab.patrol import coverage_claims
from protean_robotics.lab.patrol.claims import claims
from protean_robotics.lab.patrol.evidence import Cell, Evidence, Study
from protean_robotics.lab.patrol.page import build

CONFIRMED, REFUTED, UNDECIDED, NO_DATA = Verdict


def row(length_m: float, mae_m: float, **changes: Any) -> dict[str, Any]:
    lap = {"length_m": length_m, "mae_m": mae_m, "turns": 119.0, "maa": 1.94, "maa_fold": 0.77}
    waypoints = {
        "reached": 90,
        "inside_obstacle": 10,
        "timed_out": 0,
        "unreachable": 0,
        "stuck": 0,
        "longest_lap_s": 118.0,
        "planned": lap,
        "driven": lap,
    }
    by_way = [{"way_m": 1000.0, "coverable_fraction": 0.8125}]
    found = {
        "contacts": 0,
        "robots": [{"waypoints": None}, {"waypoints": waypoints}],
        "coverage": {"unevenness": 0.5, "by_way": by_way},
        "predictions": [],
    }
    return found | changes


def study(case: str, value: str, *rows: dict[str, Any]) -> Study:
    return Study("0.1.0", "1..2", [Cell(case, value, dict(enumerate(rows, 1)))])


def made_up(**studies: Study) -> Evidence:
    """Synthetic results of all three experiments."""
    known = {
        "patrol_alpha": study("paper_fit", "1.7", row(116.0, 0.9), row(118.0, 0.94)),
        "patrol_square": study("awg", "small", row(75.0, 0.71)),
        "coverage_sources": study("chebyshev_raw", "", row(1.0, 1.0)),
    }
    return Evidence(known | studies)


def line(page: Page, start: str) -> str:
    return next(line for line in page.text.splitlines() if line.startswith(start))


def test_the_page_is_what_it_was() -> None:
    page = build(made_up())
    assert page.text == Path(__file__).with_name("lab").joinpath("patrol.md").read_text()
    assert [image.name for image in page.images] == ["patrol-speed", "patrol-mae", "coverage-by-way"]
    assert page.images[0].series[0].reference[0].y == 0.9651


def test_without_results_the_page_has_notes_and_the_table_of_sequences() -> None:
    page = build(Evidence())
    assert not page.images and page.text.count("*No results of this experiment.*") == 3
    # The paper: 0.8309, 0.8074 in floating point.
    assert "0.8309 | 0.8074" in line(page, "| original | 2000 |")


def test_one_run_repeated_has_no_interval() -> None:
    # The mean of five times this number is not exactly this number.
    run = row(75.0, 0.958_442_808_795_306_5)
    page = build(made_up(patrol_square=study("fto", "none", *[run] * 5)))
    assert "±" not in line(page, "| none | fto | 0.96")


def test_an_observer_that_knows_the_method_has_a_column_of_its_own() -> None:
    errors = {"similar_goal_per_axis": 0.96, "kalman": 2.5, "chebyshev_key": 0.2}
    predictions = [{"method": method, "horizon_s": 5.0, "mean_m": error} for method, error in errors.items()]
    known = row(1.0, 1.0, predictions=predictions)
    page = build(made_up(coverage_sources=study("chebyshev_arcsine", "", known)))
    assert line(page, "| chebyshev arcsine |").endswith("| – | 0.96 | 0.20 |")


def test_the_numbers_of_the_patrol_are_claims() -> None:
    found = {claim.id: claim for claim in claims(Evidence())}
    for key, expected in {
        "lyapunov": CONFIRMED,
        "v": CONFIRMED,
        "case1.speed": CONFIRMED,
        "case1.mae": CONFIRMED,
        # A mean of folded angles, not of angles.
        "case1.maa": REFUTED,
        "case1.maa_folded": CONFIRMED,
        # The speed, copied.
        "case1.andc": REFUTED,
        "case2.mae": CONFIRMED,
        "case2.andc": REFUTED,
        "case1.mae_driven": NO_DATA,
        "fto.mae": NO_DATA,
    }.items():
        assert found[f"patrol.{key}"].verdict == expected, found[f"patrol.{key}"]
    assert found["patrol.case1.speed"].ours.n == 60


def test_fictive_obstacles_are_one_mission() -> None:
    found = {claim.id: claim for claim in claims(made_up(patrol_square=study("fto", "none", row(75.0, 1.5))))}
    rate = found["patrol.fto.andc"]
    assert (rate.verdict, rate.ours.value, rate.ours.n, rate.ours.of) == (UNDECIDED, 119.0 / 118.0, 1, "mission")


def test_the_numbers_of_the_coverage_are_claims() -> None:
    def cell(case: str, share: float, unevenness: float) -> Cell:
        def coverage(seed: int) -> dict[str, Any]:
            by_way = [{"way_m": 1000.0, "coverable_fraction": share * seed + 0.001 * seed}]
            return row(113.0, 0.9, coverage={"unevenness": unevenness, "by_way": by_way})

        return Cell(case, "", {seed: coverage(seed) for seed in (1, 2, 3)})

    cells = [cell("chebyshev_arcsine", 0.1, 0.9), cell("chebyshev_raw", 0.2, 0.6)]
    found = coverage_claims.claims(Evidence({"coverage_sources": Study("", "", cells)}))
    by_id = {claim.id: claim for claim in found}
    for key, expected in {
        "lyapunov": CONFIRMED,
        "lyapunov_arcsine": REFUTED,
        "v.raw.2000": CONFIRMED,
        "v.raw.falls": REFUTED,
        "v.lower": CONFIRMED,
        # −0.1, −0.2 and −0.3: the interval contains 0 by 0.05.
        "covers_more": UNDECIDED,
        "more_even": REFUTED,
    }.items():
        assert by_id[f"coverage.{key}"].verdict == expected, by_id[f"coverage.{key}"]
    assert by_id["coverage.v.arcsine.10000"].ours.n == 200
