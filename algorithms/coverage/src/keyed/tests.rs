use planner_view::waypoint::WaypointKind;

use super::*;
use crate::testing::{disc_coverage, empty};

type Change = fn(&mut KeyedParams);

const START: Point2<f64> = Point2::new(2.0, 7.0);

fn planner(key: [u8; 32]) -> KeyedCoverage {
    let (workplace, parts) = empty();
    KeyedCoverage::new(&workplace, &parts, START, 0.1, key, KeyedParams::default()).unwrap()
}

fn goals(planner: &mut KeyedCoverage, mut from: Point2<f64>, count: usize) -> Vec<Point2<f64>> {
    let next = || {
        from = planner.next_goal(from)?.waypoint.point;
        Some(from)
    };
    core::iter::from_fn(next).take(count).collect()
}

#[test]
fn the_holder_of_the_key_has_the_same_sub_goals() {
    let ours = goals(&mut planner([4; 32]), START, 60);
    assert_eq!(ours, goals(&mut planner([4; 32]), START, 60));
    let theirs = goals(&mut planner([5; 32]), START, 60);
    let same = ours.iter().zip(&theirs).filter(|(a, b)| a == b).count();
    assert_eq!(same, 0);
}

#[test]
fn most_of_the_empty_workplace_is_covered_within_800_m() {
    let (workplace, _) = empty();
    for key in 0..4 {
        let mut planner = planner([key; 32]);
        let rates = disc_coverage(&workplace, &mut planner, START, &[500.0, 800.0]);
        assert!(rates[0] > 0.72 && rates[1] > 0.92, "key {key}: {rates:?}");
    }
}

#[test]
fn an_observer_without_the_key_guesses_little_better_than_by_chance() {
    let mut planner = planner([11; 32]);
    let (mut informed, mut blind) = (Vec::new(), Vec::new());
    let mut from = START;
    for step in 0..100 {
        let guesses = (0..8).map(|guess| {
            let mut key = [guess; 32];
            key[0] = step;
            let mut other = planner.with_key(key);
            other.next_goal(from).unwrap().waypoint.point.coords
        });
        // The mean is as good a guess as the others here, and the simplest.
        let mean = guesses.sum::<nalgebra::Vector2<f64>>() / 8.0;
        from = planner.next_goal(from).unwrap().waypoint.point;
        informed.push((from.coords - mean).norm());
        blind.push((from - Point2::new(5.0, 5.0)).norm());
    }
    informed.sort_by(f64::total_cmp);
    blind.sort_by(f64::total_cmp);
    // Independent uniform goals have a median error of 3.9 m.
    assert!(informed[50] > 2.9, "{} m", informed[50]);
    assert!(blind[50] > 3.4, "{} m", blind[50]);
}

#[test]
fn rounds_follow_each_other_without_end() {
    let mut planner = planner([6; 32]);
    let mut from = START;
    let mut numbers = Vec::new();
    while planner.round() < 2 {
        let goal = planner.next_goal(from).unwrap();
        from = goal.waypoint.point;
        assert!(goal.waypoint.lap == planner.round());
        numbers.push(goal.waypoint.number);
    }
    assert!(numbers.len() < 1000, "{}", numbers.len());
    let expected: Vec<u64> = (0..numbers.len() as u64).collect();
    assert_eq!(numbers, expected);
}

#[test]
fn a_changed_workplace_keeps_key_numbers_and_what_is_covered() {
    let (workplace, parts) = empty();
    let mut ours = planner([6; 32]);
    let here = *goals(&mut ours, START, 40).last().unwrap();
    let moved = ours.clone().moved(&workplace, &parts, here).unwrap();
    assert_eq!(moved.covered(), ours.covered());
    assert!(moved.covered() > 0.3);
    let mut moved = moved;
    let goal = moved.next_goal(here).unwrap();
    assert_eq!(goal, ours.next_goal(here).unwrap());
    assert_eq!(goal.waypoint.number, 40);
}

#[test]
fn a_robot_that_is_elsewhere_is_led_back() {
    let mut planner = planner([6; 32]);
    let goal = planner.next_goal(Point2::new(-3.0, 4.0)).unwrap();
    assert_eq!(goal.waypoint.point, Point2::new(0.1, 4.0));
    assert_eq!(goal.waypoint.kind, WaypointKind::Transit);
    assert_eq!(planner.next_goal(Point2::new(f64::NAN, 4.0)), None);
    let goal = planner.next_goal(Point2::new(0.1, 4.0)).unwrap();
    assert_eq!(goal.waypoint.kind, WaypointKind::SubGoal);
}

#[test]
fn parameters_out_of_range_are_named() {
    let (workplace, parts) = empty();
    let refused = |change: Change| {
        let mut params = KeyedParams::default();
        change(&mut params);
        let planner = KeyedCoverage::new(&workplace, &parts, START, 0.1, [0; 32], params);
        planner.unwrap_err().to_string()
    };
    let cases: [(Change, &str); 5] = [
        (|p| p.cell = 0.0, "`cell` is 0"),
        (
            |p| p.cell = 0.2,
            "`cell` is 0.2: expected at most the radius that the robot covers, 0.1 m",
        ),
        (|p| p.choices = 0.5, "`choices` is 0.5"),
        (|p| p.candidates = 0, "`candidates` is 0"),
        (|p| p.round_at = 0.0, "`round_at` is 0"),
    ];
    for (change, expected) in cases {
        let error = refused(change);
        assert!(error.starts_with(expected), "{error}");
    }
}
