use super::*;
use crate::goal::GoalSource;
use crate::testing::{empty, mean_coverage};

#[test]
fn disc_coverage_at_equal_length_is_that_of_random_bounce() {
    // Means of 60 keys by an independent program; one standard error of 30 keys is at most 0.003.
    let lengths = [250.0, 500.0, 1000.0, 2000.0];
    let rates = mean_coverage(30, &lengths, |key, workplace, parts| {
        let start = Point2::new(5.0, 5.0);
        let planner = RandomBounce::new(workplace, parts, start, [key; 32]);
        (Box::new(planner), start)
    });
    for (rate, expected) in rates.iter().zip([0.394, 0.630, 0.860, 0.980]) {
        assert!((rate - expected).abs() < 0.01, "{rates:?}");
    }
}

#[test]
fn every_sub_goal_lies_on_a_wall() {
    let (workplace, parts) = empty();
    let mut from = Point2::new(3.0, 4.0);
    let mut planner = RandomBounce::new(&workplace, &parts, from, [9; 32]);
    for _ in 0..200 {
        let to = planner.next_goal(from).unwrap().waypoint.point;
        let depth = (to.x - 0.1).min(9.9 - to.x).min(to.y - 0.1).min(9.9 - to.y);
        assert!(depth.abs() < 1e-9, "{to}");
        assert!((to - from).norm() >= MIN_LEG);
        from = to;
    }
}
