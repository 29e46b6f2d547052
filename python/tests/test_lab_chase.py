"""The claims of the chasing-game paper: verdicts follow from the numbers, and the page is what it was."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import pytest

pytest.importorskip("jinja2")
pytest.importorskip("scipy")

from protean_robotics.lab.chase.claims import claims, questions
from protean_robotics.lab.chase.evidence import Cell, Evidence, Study
from protean_robotics.lab.chase.page import build
from protean_robotics.lab.claim import Claim, Verdict
from protean_robotics.lab.plans import Plan

CONFIRMED, REFUTED, UNDECIDED, NO_DATA = Verdict
GAMES = 200
SPEEDS = (0.8, 0.9, 1.0, 1.5, 2.0, 2.5, 3.0)


def mixed(value: int) -> int:
    """The generator SplitMix64: distributes the bits of a number."""
    bits = 2**64 - 1
    z = (value + 0x9E37_79B9_7F4A_7C15) & bits
    z = ((z ^ (z >> 30)) * 0xBF58_476D_1CE4_E5B9) & bits
    z = ((z ^ (z >> 27)) * 0x94D0_49BB_1331_11EB) & bits
    return z ^ (z >> 31)


def games(cell: int, percent: int) -> dict[int, tuple[int, int]]:
    """Games of two evaders; in this share of them (%) both escape.

    Which these are depends on the cell alone: cells are independent.
    """
    order = sorted(range(1, GAMES + 1), key=lambda seed: mixed(seed ^ mixed(cell)))
    return {seed: (2 if 100 * rank < percent * GAMES else 0, 2) for rank, seed in enumerate(order)}


def study(ratios: Sequence[float], methods: dict[str, Sequence[int]]) -> Study:
    """200 games per cell: methods with their chances (%) at each speed."""
    cells = [
        Cell(method, ratio, games(sum(method.encode()) * 100 + int(10 * ratio), percent), 400 - percent * 4)
        for method, percents in methods.items()
        for ratio, percent in zip(ratios, percents, strict=True)
    ]
    return Study("test", "0.1.0", "1..200", {method: method.replace("_", " ") for method in methods}, cells)


SPEED: dict[str, Sequence[int]] = {
    "braitenberg": (0, 0, 1, 1, 2, 3, 4),
    "potential_field": (1, 2, 4, 20, 50, 65, 75),
    "rrt_star_line": (5, 10, 25, 62, 80, 88, 90),
    "rrt_star_arc": (4, 9, 22, 60, 78, 86, 88),
}
KNOWLEDGE: dict[str, Sequence[int]] = {
    "exact": (5, 10, 25, 62, 80, 88, 90),
    "particle_filter": (35, 50, 60, 85, 92, 95, 96),
}


def plan(case: str, scene: str, seed: int, closest: float | None) -> Plan:
    return Plan(case, scene, seed, 5000, closest is not None, None if closest is None else 18.0, closest, 17.14, 0.5)


def evidence() -> Evidence:
    seeds = range(1, 41)
    plans = [plan("rrt_star_arc", "start", s, 1.0) for s in seeds]
    plans += [plan("rrt_star_arc_paper", "start", s, None if s % 3 else 1.0) for s in seeds]
    plans += [plan("rrt_star_line", "random", s, 1.5 + 0.01 * s) for s in seeds]
    knowledge = study(SPEEDS, KNOWLEDGE)
    studies = {"escape_vs_speed": study(SPEEDS, SPEED), "knowledge": knowledge, "knowledge_paper": knowledge}
    return Evidence(studies, plans)


def verdict(evidence: Evidence, letter: str) -> Verdict:
    question = next(question for question in questions(evidence) if question.statement.letter == letter)
    assert question.ours.numbers
    return question.ours.verdict


def of_speed(letter: str, ratios: Sequence[float] = SPEEDS, **methods: Sequence[int]) -> Verdict:
    """Verdict with other chances of some methods."""
    known = SPEED if ratios is SPEEDS else {}
    return verdict(Evidence({"escape_vs_speed": study(ratios, known | methods)}), letter)


def of_knowledge(letter: str, **methods: Sequence[int]) -> Verdict:
    return verdict(Evidence({"knowledge": study(SPEEDS, KNOWLEDGE | methods)}), letter)


def test_the_page_is_what_it_was() -> None:
    page = build(evidence())
    assert page.text == Path(__file__).with_name("lab").joinpath("chase.md").read_text()
    names = [image.name for image in page.images]
    assert names == ["chase-escape-vs-speed", "chase-knowledge", "chase-knowledge-paper"]
    assert all(f"(images/{name}.svg)" in page.text for name in names)
    assert sum(len(series.reference) for series in page.images[2].series) == 6


def test_without_results_the_page_has_notes() -> None:
    page = build(Evidence())
    assert not page.images and page.text.count("*No results of this experiment.*") == 4
    assert "**confirmed**" not in page.text and "**refuted**" not in page.text


def test_rrt_star_evaders_of_another_experiment_are_columns_beside_the_others() -> None:
    more = evidence()
    more.studies["escape_vs_speed_rrt_star"] = study((0.8, 1.0), {"rrt_star_other": (10, 90)})
    text = build(more).text
    assert "| rrt star arc | rrt star other |\n" in text
    assert "| rrt star other | 0.8× … 1.0× |" in text
    assert "| 88 % (83 … 92) | – |\n" in text


def test_failed_games_stand_apart() -> None:
    some = study((0.8, 1.0), {"exact": (10, 90)})
    cells = [replace(some.cells[0], failed=3, games=dict(list(some.cells[0].games.items())[:150])), some.cells[1]]
    text = build(Evidence({"knowledge": replace(some, cells=cells), "knowledge_paper": replace(some, cells=cells)})).text
    assert "| games | 150 to 200 (+ 3 failed) |" in text and "| exact | 0.8× | 150 (+ 3 failed) |" in text


def test_clear_data_give_verdicts() -> None:
    expected = {"b": UNDECIDED, "c": REFUTED, "g": REFUTED}
    for letter in ("a", "b", "c", "d", "e", "f1", "f2", "g", "h"):
        assert verdict(evidence(), letter) == expected.get(letter, CONFIRMED), letter


def test_one_reversed_speed_refutes_an_order_and_equality_does_not() -> None:
    assert of_speed("a", rrt_star_line=(5, 10, 25, 62, 80, 50, 90)) == REFUTED
    assert of_speed("a", rrt_star_line=(5, 10, 25, 62, 80, 64, 90)) == UNDECIDED
    # At least as often as never.
    assert of_speed("a", braitenberg=(0,) * 7, potential_field=(0,) * 7, rrt_star_line=(0,) * 7) == CONFIRMED


def test_critical_speeds_are_judged_by_their_intervals() -> None:
    assert of_speed("b", potential_field=(0, 0, 1, 2, 10, 40, 80)) == REFUTED
    assert of_speed("b", potential_field=(0,) * 7) == REFUTED
    assert of_speed("e", rrt_star_line=(100,) * 7) == REFUTED
    assert of_speed("e", rrt_star_line=(60, 55, 50, 40, 30, 20, 10)) == UNDECIDED
    assert of_speed("e", rrt_star_line=(5, 10, 20, 50, 70, 85, 95)) == UNDECIDED
    # Two wide steps do not show where in them a chance crosses one half.
    assert of_speed("b") == UNDECIDED
    assert of_speed("b", (1.0, 1.8, 1.9, 2.0, 3.0), potential_field=(0, 10, 45, 60, 90)) == CONFIRMED


def test_a_chance_that_falls_again_has_all_its_brackets_on_the_page() -> None:
    falls = study(SPEEDS, SPEED | {"potential_field": (1, 2, 4, 100, 26, 73, 75)})
    text = build(Evidence({"escape_vs_speed": falls})).text
    assert "| potential field | 1.0× … 1.5×, falls 1.5× … 2.0×, 2.0× … 2.5× | 1.0× … 2.5× |" in text


def test_a_drop_must_be_seen_or_ruled_out() -> None:
    assert of_speed("c", potential_field=(1, 2, 4, 20, 70, 50, 50)) == CONFIRMED
    assert of_speed("c", potential_field=(1, 2, 4, 20, 51, 50, 50)) == UNDECIDED


def test_braitenberg_vehicles_need_only_one_speed_to_have_a_critical_one() -> None:
    assert of_speed("d", braitenberg=(0, 0, 0, 5, 20, 40, 70)) == REFUTED
    assert of_speed("d", braitenberg=(0, 0, 0, 5, 20, 40, 50)) == UNDECIDED


def test_knowledge_may_help_not_matter_or_harm() -> None:
    same = KNOWLEDGE["exact"]
    assert of_knowledge("f2", particle_filter=same) == UNDECIDED
    # Five points are not ruled out.
    assert of_knowledge("f1", particle_filter=same) == UNDECIDED
    assert of_knowledge("f1", particle_filter=(35, 50, 5, 85, 92, 95, 96)) == REFUTED
    assert of_knowledge("f2", particle_filter=(5, 10, 25, 90, 99, 100, 100)) == REFUTED
    assert of_knowledge("f1", exact=(0,) * 7, particle_filter=(0,) * 7) == REFUTED


def test_plans_are_counted() -> None:
    def of(letter: str, case: str, scene: str, closest: Callable[[int], float | None]) -> Verdict:
        plans = [plan(case, scene, seed, closest(seed)) for seed in range(1, 101)]
        return verdict(Evidence(plans=plans), letter)

    arcs = {every: of("g", "rrt_star_arc", "start", lambda s, e=every: None if s % e else 1.0) for every in (1, 2, 10)}
    assert arcs == {1: REFUTED, 2: UNDECIDED, 10: CONFIRMED}
    assert of("h", "rrt_star_arc", "start", lambda _: 1.0) == NO_DATA
    assert of("h", "rrt_star_line", "random", lambda s: 1.0 + 0.001 * s) == CONFIRMED
    assert of("h", "rrt_star_line", "random", lambda s: 0.5 + 0.001 * s) == REFUTED
    assert of("h", "rrt_star_line", "random", lambda s: 0.75 + (-0.2 if s % 2 else 0.2)) == UNDECIDED


def test_a_missing_cell_is_missing_data() -> None:
    whole = study(SPEEDS, SPEED)
    cells = [cell for cell in whole.cells if cell.method != "rrt_star_line" or cell.ratio < 3.0]
    some = Evidence({"escape_vs_speed": replace(whole, cells=cells)})
    assert (verdict(some, "a"), verdict(some, "d"), verdict(Evidence(), "f2")) == (NO_DATA, CONFIRMED, NO_DATA)


def test_every_statement_and_every_value_of_the_figures_is_a_claim() -> None:
    for some in (evidence(), Evidence()):
        found = claims(some)
        assert len({claim.id for claim in found}) == len(found) == 2 * 9 + 12 + 6
        for claim in found:
            has_data = claim.verdict != NO_DATA
            assert has_data == (claim.ours.n > 0) == (claim.ours.interval is not None), claim


def test_a_claim_has_the_number_that_decides() -> None:
    found: dict[str, Claim] = {claim.id: claim for claim in claims(evidence())}
    # 35 % of 200 games against 3 of 10.
    value = found["chase.fig3.particle_filter.0.8"]
    assert (value.published.value, value.ours.value, value.ours.n) == (0.3, 0.35, 200)
    assert value.verdict == CONFIRMED
    missing = found["chase.fig2.rrt_star_line.1.5"]
    assert (missing.verdict, missing.ours.n) == (NO_DATA, 0)
    assert found["chase.a.ours"].ours.text.endswith(", the least of 8")
    crossing = found["chase.e.ours"]
    assert (crossing.ours.text, len(crossing.finding.numbers)) == ("1.0× … 1.5×", 2)
    rise = found["chase.f2.ours"].ours.interval
    assert rise is not None and rise.low > 0.0
    arcs = found["chase.g.paper"].ours
    assert (arcs.value, arcs.n) == (0.325, 40)


def test_values_of_a_figure_are_corrected_together_and_the_page_says_which_are_refuted() -> None:
    def text(line: Sequence[int], braitenberg: int) -> tuple[str, dict[str, Verdict]]:
        paper = study(
            (1.5, 2.0, 2.5, 3.0),
            {"braitenberg": (0, 0, 0, braitenberg), "potential_field": (20, 70, 50, 50), "rrt_star_line": line},
        )
        some = Evidence({"escape_vs_speed_paper": paper})
        verdicts = {claim.id: claim.verdict for claim in claims(some) if claim.id.startswith("chase.fig2.")}
        return build(some).text, verdicts

    # 0 of 200 games against 1 of 10: p = 0.0476 alone.
    page, verdicts = text((60, 80, 70, 70), 0)
    assert REFUTED not in verdicts.values()
    assert "The tests refute none of the 12 published values. 1 of them lie above our chances, 0 below." in page
    page, verdicts = text((2, 80, 70, 70), 0)
    assert [id for id, found in verdicts.items() if found == REFUTED] == ["chase.fig2.rrt_star_line.1.5"]
    assert "refute 1 of the 12 published values: rrt star line at 1.5× (fewer evaders escape here)." in page
