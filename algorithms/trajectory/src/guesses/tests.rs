//! Guesses against the limits.

use geometry::pose::Pose2;
use geometry::shape::Aabb;
use nalgebra::Point2;
use proptest::prelude::*;

use super::*;
use crate::RobotLimits;
use crate::obstacle_field::ObstacleField;
use crate::validity_check;

fn pose() -> impl Strategy<Value = Pose2> {
    (-5.0..5.0f64, -5.0..5.0f64, -4.0..4.0f64).prop_map(|(x, y, theta)| Pose2::new(x, y, theta))
}

fn problem() -> impl Strategy<Value = Problem> {
    (
        pose(),
        pose(),
        (
            0.05..1.0f64,
            0.1..4.0f64,
            prop_oneof![Just(0.0), 0.1..1.0f64],
        ),
        proptest::option::of(0.1..2.0f64),
        any::<bool>(),
    )
        .prop_map(
            |(start, goal, (v_max, omega_max, back), acceleration, heading)| Problem {
                start,
                start_speed: acceleration.map(|_| 0.0),
                start_turn_rate: None,
                goal: goal.position(),
                goal_heading: heading.then_some(goal.theta),
                goal_speed: None,
                limits: RobotLimits {
                    v_min: 0.0 - back * v_max,
                    acceleration,
                    ..RobotLimits::simple(v_max, omega_max)
                },
                obstacles: Vec::new(),
                clearance: 0.1,
                bounds: Aabb {
                    min: Point2::new(-100.0, -100.0),
                    max: Point2::new(100.0, 100.0),
                },
                start_tolerance: 0.0,
            },
        )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn guesses_keep_the_limits_and_lead_to_the_goal(problem in problem()) {
        let path = [PathLeg::Segment { from: problem.start.position(), to: problem.goal }];
        let field = ObstacleField::new(&problem).unwrap();
        let guesses: Vec<_> = guesses(&problem, &[path.to_vec()], Some(0.0)).collect();
        prop_assert!(guesses.len() >= 2);
        let reverses = guesses.iter().any(|samples| samples.iter().any(|sample| sample.v < 0.0));
        prop_assert_eq!(reverses, problem.limits.may_reverse());
        for samples in &guesses {
            let report = validity_check::report(&problem, &field, samples);
            prop_assert!(report.is_valid(), "{report}");
            // Headings of a jump by a whole turn would be far from any motion.
            let jump = samples.windows(2).map(|pair| (pair[1].theta - pair[0].theta).abs());
            prop_assert!(jump.fold(0.0, f64::max) < 1.0);
        }
    }
}

#[test]
fn guesses_are_the_same_every_time_and_all_different() {
    let problem = Problem {
        start: Pose2::new(2.4, 1.8, 0.3),
        start_speed: None,
        start_turn_rate: None,
        goal: Point2::new(1.0, 1.0),
        goal_heading: Some(1.0),
        goal_speed: None,
        limits: RobotLimits::simple(0.15, 0.3),
        obstacles: Vec::new(),
        clearance: 0.1,
        bounds: Aabb {
            min: Point2::new(-10.0, -10.0),
            max: Point2::new(10.0, 10.0),
        },
        start_tolerance: 0.0,
    };
    let path = [PathLeg::Segment {
        from: problem.start.position(),
        to: problem.goal,
    }];
    let paths = [path.to_vec()];
    let all = || guesses(&problem, &paths, Some(0.0)).collect::<Vec<_>>();
    let found = all();
    assert_eq!(found, all());
    // Three connections in both directions, and words of three kinds straight to the goal.
    assert!((9..=15).contains(&found.len()), "{}", found.len());
    for (i, a) in found.iter().enumerate() {
        assert!(found.iter().skip(i + 1).all(|b| a != b));
    }
    let cusps = |samples: &[Sample]| {
        let pairs = samples.windows(2);
        pairs.filter(|pair| pair[0].v * pair[1].v < 0.0).count()
    };
    assert!(found.iter().any(|samples| cusps(samples) > 0));
}
