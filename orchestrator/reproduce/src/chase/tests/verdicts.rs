//! Tests that verdicts follow from the numbers.

use super::super::claims::Question;
use super::super::claims::questions;
use super::super::evidence::{Evidence, Study};
use super::{SPEEDS, evidence, knowledge, page, plan, speed, study};
use crate::claim::Verdict;
use crate::plans::Plans;

fn verdict(evidence: &Evidence, letter: &str) -> Verdict {
    let questions = questions(evidence);
    let is_asked = |question: &&Question| question.statement.letter == letter;
    let claim = questions.iter().find(is_asked).unwrap();
    assert!(!claim.ours.numbers.is_empty());
    claim.ours.verdict
}

fn of_speed(study: Study, letter: &str) -> Verdict {
    let evidence = Evidence {
        speed: Some(study),
        ..Evidence::default()
    };
    verdict(&evidence, letter)
}

fn of_knowledge(study: Study, letter: &str) -> Verdict {
    let evidence = Evidence {
        knowledge: Some(study),
        ..Evidence::default()
    };
    verdict(&evidence, letter)
}

/// Returns the study with another row for one method.
fn with(mut base: Study, method: &str, percents: &[u32]) -> Study {
    let other = study(&SPEEDS, &[(method, percents)]);
    for cell in &mut base.cells {
        if let Some(changed) = other.cell(&cell.method, cell.ratio) {
            *cell = changed.clone();
        }
    }
    base
}

#[test]
fn clear_data_give_verdicts() {
    let evidence = evidence();
    for (letter, expected) in [
        ("a", Verdict::Confirmed),
        ("b", Verdict::Undecided),
        ("c", Verdict::Refuted),
        ("d", Verdict::Confirmed),
        ("e", Verdict::Confirmed),
        ("f1", Verdict::Confirmed),
        ("f2", Verdict::Confirmed),
        ("g", Verdict::Refuted),
        ("h", Verdict::Confirmed),
    ] {
        assert_eq!(verdict(&evidence, letter), expected, "{letter}");
    }
}

#[test]
fn one_reversed_speed_refutes_an_order_and_equality_does_not() {
    let reversed = with(speed(), "rrt_star_line", &[5, 10, 25, 62, 80, 50, 90]);
    assert_eq!(of_speed(reversed, "a"), Verdict::Refuted);
    let unclear = with(speed(), "rrt_star_line", &[5, 10, 25, 62, 80, 64, 90]);
    assert_eq!(of_speed(unclear, "a"), Verdict::Undecided);
    let none = study(
        &SPEEDS,
        &[
            ("braitenberg", &[0; 7]),
            ("potential_field", &[0; 7]),
            ("rrt_star_line", &[0; 7]),
        ],
    );
    assert_eq!(
        of_speed(none, "a"),
        Verdict::Confirmed,
        "at least as often as never"
    );
}

#[test]
fn critical_speeds_are_judged_by_their_intervals() {
    let late = with(speed(), "potential_field", &[0, 0, 1, 2, 10, 40, 80]);
    assert_eq!(of_speed(late, "b"), Verdict::Refuted);
    let never = with(speed(), "potential_field", &[0; 7]);
    assert_eq!(of_speed(never, "b"), Verdict::Refuted);
    let always = with(speed(), "rrt_star_line", &[100; 7]);
    assert_eq!(of_speed(always, "e"), Verdict::Refuted);
    let falling = with(speed(), "rrt_star_line", &[60, 55, 50, 40, 30, 20, 10]);
    assert_eq!(of_speed(falling, "e"), Verdict::Undecided);
    let border = with(speed(), "rrt_star_line", &[5, 10, 20, 50, 70, 85, 95]);
    assert_eq!(of_speed(border, "e"), Verdict::Undecided);
    // Two wide steps do not show where in them a chance crosses one half.
    assert_eq!(of_speed(speed(), "b"), Verdict::Undecided);
    let narrow = study(
        &[1.0, 1.8, 1.9, 2.0, 3.0],
        &[("potential_field", &[0, 10, 45, 60, 90])],
    );
    assert_eq!(of_speed(narrow, "b"), Verdict::Confirmed);
}

#[test]
fn a_chance_that_falls_again_has_all_its_brackets_on_the_page() {
    let falls = with(speed(), "potential_field", &[1, 2, 4, 100, 26, 73, 75]);
    let evidence = Evidence {
        speed: Some(falls),
        ..Evidence::default()
    };
    let text = page(&evidence).unwrap().text;
    let row = "| potential field | 1.0× … 1.5×, falls 1.5× … 2.0×, 2.0× … 2.5× | 1.0× … 2.5× |";
    assert!(text.contains(row), "{text}");
}

#[test]
fn a_drop_must_be_seen_or_ruled_out() {
    let drop = with(speed(), "potential_field", &[1, 2, 4, 20, 70, 50, 50]);
    assert_eq!(of_speed(drop, "c"), Verdict::Confirmed);
    let open = with(speed(), "potential_field", &[1, 2, 4, 20, 51, 50, 50]);
    assert_eq!(of_speed(open, "c"), Verdict::Undecided);
}

#[test]
fn braitenberg_vehicles_need_only_one_speed_to_have_a_critical_one() {
    let fast = with(speed(), "braitenberg", &[0, 0, 0, 5, 20, 40, 70]);
    assert_eq!(of_speed(fast, "d"), Verdict::Refuted);
    let half = with(speed(), "braitenberg", &[0, 0, 0, 5, 20, 40, 50]);
    assert_eq!(of_speed(half, "d"), Verdict::Undecided);
}

#[test]
fn knowledge_may_help_not_matter_or_harm() {
    let same = with(knowledge(), "particle_filter", &[5, 10, 25, 62, 80, 88, 90]);
    assert_eq!(of_knowledge(same.clone(), "f2"), Verdict::Undecided);
    assert_eq!(
        of_knowledge(same, "f1"),
        Verdict::Undecided,
        "five points are not ruled out"
    );
    let harm = with(knowledge(), "particle_filter", &[35, 50, 5, 85, 92, 95, 96]);
    assert_eq!(of_knowledge(harm, "f1"), Verdict::Refuted);
    let late = with(
        knowledge(),
        "particle_filter",
        &[5, 10, 25, 90, 99, 100, 100],
    );
    assert_eq!(of_knowledge(late, "f2"), Verdict::Refuted);
    let never = study(&SPEEDS, &[("exact", &[0; 7]), ("particle_filter", &[0; 7])]);
    assert_eq!(of_knowledge(never, "f1"), Verdict::Refuted);
}

#[test]
fn plans_are_counted() {
    let of = |plans: Vec<_>, letter: &str| {
        let evidence = Evidence {
            plans: Some(Plans(plans)),
            ..Evidence::default()
        };
        verdict(&evidence, letter)
    };
    let arcs = |every: u64| {
        let found = move |s: u64| s.is_multiple_of(every).then_some(1.0);
        (1..=100)
            .map(move |s| plan("rrt_star_arc", "start", s, found(s)))
            .collect::<Vec<_>>()
    };
    assert_eq!(of(arcs(1), "g"), Verdict::Refuted);
    assert_eq!(of(arcs(2), "g"), Verdict::Undecided);
    assert_eq!(of(arcs(10), "g"), Verdict::Confirmed);
    assert_eq!(of(arcs(1), "h"), Verdict::NoData);
    let lines = |closest: fn(u64) -> f64| {
        let plan = |s| plan("rrt_star_line", "random", s, Some(closest(s)));
        (1..=100).map(plan).collect::<Vec<_>>()
    };
    assert_eq!(
        of(lines(|s| 1.0 + 0.001 * s as f64), "h"),
        Verdict::Confirmed
    );
    assert_eq!(of(lines(|s| 0.5 + 0.001 * s as f64), "h"), Verdict::Refuted);
    assert_eq!(
        of(lines(|s| 0.75 + if s % 2 == 0 { 0.2 } else { -0.2 }), "h"),
        Verdict::Undecided
    );
}

#[test]
fn a_missing_cell_is_missing_data() {
    let mut study = speed();
    study
        .cells
        .retain(|c| c.method != "rrt_star_line" || c.ratio < 3.0);
    assert_eq!(of_speed(study.clone(), "a"), Verdict::NoData);
    assert_eq!(of_speed(study, "d"), Verdict::Confirmed);
    assert_eq!(verdict(&Evidence::default(), "f2"), Verdict::NoData);
}
