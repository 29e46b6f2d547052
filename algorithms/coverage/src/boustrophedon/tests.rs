use super::*;
use crate::testing::{disc_coverage, empty};

#[test]
fn the_empty_workplace_is_covered_whole_in_500_m() {
    let (workplace, parts) = empty();
    let start = Point2::new(0.1, 0.1);
    let mut planner = Boustrophedon::new(&workplace, &parts, start, 0.1).unwrap();
    let (mut from, mut length) = (start, 0.0);
    while let Some(goal) = planner.next_goal(from) {
        let to = goal.waypoint.point;
        length += (to - from).norm();
        from = to;
    }
    assert!((length - 499.8).abs() < 1e-9, "{length}");
    let mut again = Boustrophedon::new(&workplace, &parts, start, 0.1).unwrap();
    let rates = disc_coverage(&workplace, &mut again, start, &[250.0, 499.7, 600.0]);
    assert!((rates[0] - 0.5).abs() < 0.003, "{rates:?}");
    assert_eq!(rates[2], 1.0);
}

#[test]
fn lanes_end_when_all_are_driven() {
    let (workplace, parts) = empty();
    let mut from = Point2::new(4.0, 7.0);
    let mut planner = Boustrophedon::new(&workplace, &parts, from, 0.1).unwrap();
    let mut laps = Vec::new();
    while let Some(goal) = planner.next_goal(from) {
        from = goal.waypoint.point;
        laps.push(goal.waypoint.lap);
    }
    assert_eq!(laps, [0; 100]);
    assert_eq!(planner.next_goal(from), None);
}

#[test]
fn no_width_is_refused() {
    let (workplace, parts) = empty();
    let start = Point2::new(1.0, 1.0);
    let error = Boustrophedon::new(&workplace, &parts, start, 0.0).unwrap_err();
    assert_eq!(error, BoustrophedonError::TooManyLanes { spacing: 0.0 });
}
