"""The targets of patrols of teams: verdicts follow from the missions, and the page has a row for each cell."""

from typing import Any

import pytest

pytest.importorskip("jinja2")
pytest.importorskip("scipy")

from protean_robotics.lab.claim import Verdict
from protean_robotics.lab.patrol_teams.claims import claims
from protean_robotics.lab.patrol_teams.evidence import Cell, Evidence, Study
from protean_robotics.lab.patrol_teams.page import build

CONFIRMED, REFUTED, UNDECIDED, NO_DATA = Verdict


def rows(*missions: tuple[float, float]) -> dict[int, dict[str, Any]]:
    """Missions with these worst idlenesses (s) and least distances (m)."""
    return {
        seed: {"patrols": [{"worst_idleness_s": worst, "mean_idleness_s": worst / 2.0, "nearest_m": nearest}]}
        for seed, (worst, nearest) in enumerate(missions, 1)
    }


def made_up(*missions: tuple[float, float]) -> Evidence:
    """Two guards around an octagon of 48 m."""
    study = Study("0.1.0", "1..2", [Cell("", "octagon", 2, rows(*missions))], {"octagon": 48.0})
    return Evidence({"patrol_team": study})


def verdicts(evidence: Evidence) -> dict[str, Verdict]:
    return {claim.id: claim.verdict for claim in claims(evidence)}


def test_every_mission_must_keep_a_bound() -> None:
    found = verdicts(made_up((61.0, 20.0), (66.0, 6.0)))
    assert found["teams.idleness.octagon"] == found["teams.distance.octagon"] == CONFIRMED
    found = verdicts(made_up((61.0, 5.9), (66.1, 20.0)))
    assert found["teams.idleness.octagon"] == found["teams.distance.octagon"] == REFUTED
    assert found["teams.idleness.angle"] == found["teams.failed.failure"] == NO_DATA


def test_a_gap_is_closed_within_a_lap() -> None:
    cells = [Cell("failure", "", 4, rows((119.0, 1.0))), Cell("trapped", "", 4, rows((60.0, 1.0), (121.0, 1.0)))]
    found = Evidence({"patrol_failure": Study("0.1.0", "1", cells)})
    assert verdicts(found)["teams.failed.failure"] == CONFIRMED
    assert verdicts(found)["teams.failed.trapped"] == REFUTED
    assert "| spread, one drives around between walls | 45.2 | 60.0 | 121.0 | 1.01 |" in build(found).text


def test_the_page_has_a_row_for_each_cell_and_notes_without_results() -> None:
    page = build(made_up((61.0, 20.0), (66.0, 6.0)))
    assert "| octagon | 2 | 31.8 | 66.0 | 1.100 | 6.00 | 1.00 |" in page.text
    assert page.text.count("*No results of this experiment.*") == 4
    assert [image.name for image in page.images] == ["patrol-teams-idleness"]
    assert build(Evidence()).text.count("*No results of this experiment.*") == 5


def intervals(*seconds: float) -> Evidence:
    """Four robots by SEBS with these mean times between visits."""
    found = {seed: {"patrols": [{"mean_interval_s": value}]} for seed, value in enumerate(seconds, 1)}
    return Evidence({"patrol_strategies": Study("0.1.0", "1..3", [Cell("grid", "", 4, found, "state_exchange")])})


def test_results_of_others_lie_in_the_interval_for_one_more_mission_or_not() -> None:
    # 55.5 and 56.5 s are theirs.
    for seconds, verdict in (
        ((55.0, 56.0, 57.0), CONFIRMED),
        ((50.0, 50.1, 50.2), REFUTED),
        ((55.5, 55.6, 55.7), UNDECIDED),
    ):
        assert verdicts(intervals(*seconds))["teams.strategy.state_exchange"] == verdict
    assert verdicts(intervals(50.0, 50.1, 50.2))["teams.strategy.cyclic"] == NO_DATA
    page = build(intervals(50.0, 50.1, 50.2)).text
    assert "| `state_exchange` | SEBS | 55.5, 56.5 | 50.1 s | 49.6 … 50.6 | **refuted** |" in page


def test_the_best_method_of_an_observer_counts() -> None:
    def mission(kalman: float, particles: float) -> dict[str, Any]:
        errors = {"kalman": kalman, "particles": particles}
        predictions = [{"method": method, "horizon_s": 5.0, "mean_m": error} for method, error in errors.items()]
        return {"predictions": predictions, "patrols": [{"mean_idleness_s": 20.0, "worst_idleness_s": 50.0}]}

    cell = Cell("markov", "", 1, {1: mission(2.0, 1.0), 2: mission(1.0, 4.0)})
    assert cell.errors() == {5.0: 1.5}
    page = build(Evidence({"patrol_predictability": Study("0.1.0", "1..2", [cell])})).text
    assert "| Markov chain among all corners, keyed | 1.50 | 20.0 | 50.0 |" in page


def test_attacks_are_counted_over_missions_by_adversary() -> None:
    def mission(detected: int) -> dict[str, Any]:
        return {"attacks": [{"method": method, "attacks": 10, "detected": detected} for method in ("random", "history")]}

    cell = Cell("keyed", "", 3, {1: mission(5), 2: mission(10)}, duration=34)
    assert cell.attacks("random") == (15, 20)
    page = build(Evidence({"patrol_attacks": Study("0.1.0", "1..2", [cell])})).text
    # The ends by Wilson's formula: 0.531 and 0.888.
    assert "| zig-zag, keyed | 34 | 75.0 (53.1 … 88.8) | 75.0 (53.1 … 88.8) | – | – |" in page
