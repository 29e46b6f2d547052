//! Robots with inertia.

use nalgebra::Point2;
use trajectory::{Method, Options, PlanError, Problem, Status};

use crate::problems::{board, cluttered, disc, faults, motors, options, plan};

fn driven() -> Problem {
    Problem {
        limits: motors(),
        start_speed: Some(0.0),
        start_turn_rate: Some(0.0),
        goal_speed: Some(0.0),
        ..cluttered()
    }
}

#[test]
fn every_method_keeps_the_accelerations() {
    let problem = driven();
    for method in Method::ALL {
        let plan = plan(&problem, &options(method)).unwrap();
        assert_eq!(faults(&problem, &plan), [""; 0], "{method:?}");
        assert_eq!(plan.status, Status::Planned);
        // The fallback plan stops at every joint.
        let most = if method == Method::Tangent { 1.0 } else { 0.1 };
        assert!(plan.gap() < most, "{method:?}: {}", plan.gap());
    }
}

#[test]
fn a_straight_motion_reaches_the_lower_bound() {
    let mut problem = driven();
    problem.obstacles.clear();
    problem.goal = problem.start.position() + problem.start.forward() * 3.0;
    let plan = plan(&problem, &Options::default()).unwrap();
    // 0.44 s to accelerate and brake: 3 m at 0.22 m/s and 0.44 s more.
    assert!((plan.lower_bound - (3.0 / 0.22 + 0.44)).abs() < 1e-9);
    assert!(plan.gap() < 1e-3, "{}", plan.gap());
    assert_eq!(faults(&problem, &plan), [""; 0]);
}

#[test]
fn refinement_is_faster_than_its_initial_curve() {
    let problem = driven();
    let curve = Options {
        refine: false,
        ..Options::default()
    };
    let curve = plan(&problem, &curve).unwrap();
    let refined = plan(&problem, &Options::default()).unwrap();
    assert_eq!(faults(&problem, &curve), [""; 0]);
    assert!(refined.final_time < curve.final_time);
}

#[test]
fn a_moving_start_goes_on_moving() {
    for (speed, turn) in [(0.1, 0.0), (0.2, 0.1), (0.1, -0.8), (0.0, 1.5)] {
        let problem = Problem {
            start_speed: Some(speed),
            start_turn_rate: Some(turn),
            goal_heading: Some(1.2),
            ..driven()
        };
        for method in Method::ALL {
            let plan = plan(&problem, &options(method)).unwrap();
            assert_eq!(
                faults(&problem, &plan),
                [""; 0],
                "{method:?} {speed} {turn}"
            );
        }
    }
}

#[test]
fn a_robot_that_cannot_stop_in_time_has_no_plan() {
    let mut problem = driven();
    problem.obstacles = vec![disc(0.5, 0.1, 0.2)];
    (problem.start.x, problem.start.y, problem.start.theta) = (0.22, 0.1, 0.0);
    problem.start_speed = Some(0.2);
    // 4 cm for stopping, 5 mm to the goal.
    match plan(&problem, &Options::default()) {
        Err(PlanError::Infeasible(_)) => {}
        other => panic!("{other:?}"),
    }
}

#[test]
fn one_acceleration_may_be_limited_alone() {
    for (acceleration, angular) in [(Some(0.5), None), (None, Some(3.0))] {
        let mut problem = driven();
        problem.limits.acceleration = acceleration;
        problem.limits.angular_acceleration = angular;
        for method in Method::ALL {
            let plan = plan(&problem, &options(method)).unwrap();
            assert_eq!(
                faults(&problem, &plan),
                [""; 0],
                "{method:?} {acceleration:?}"
            );
        }
    }
}

#[test]
fn the_last_plan_shortens_the_search() {
    let problem = driven();
    let first = plan(&problem, &Options::default()).unwrap();
    let middle = first.samples[first.samples.len() / 3];
    let mut next = problem.clone();
    (next.start.x, next.start.y, next.start.theta) = (middle.x, middle.y, middle.theta);
    (next.start_speed, next.start_turn_rate) = (Some(middle.v), Some(middle.omega));
    next.obstacles.push(disc(4.4, 0.8, 0.1));
    let warm = trajectory::plan(&next, &Options::default(), Some(&first), &mut || false).unwrap();
    assert_eq!(faults(&next, &warm), [""; 0]);
    let cold = plan(&next, &Options::default()).unwrap();
    assert!(warm.final_time < 1.01 * cold.final_time);
    // The path is unchanged: it takes as long as the rest of the first.
    assert!((warm.final_time + middle.t) < 1.005 * first.final_time);
}

#[test]
fn a_short_path_has_a_plan() {
    for distance in [1e-3, 0.01, 0.1] {
        let problem = Problem {
            goal: Point2::new(0.1 + distance, 0.1),
            obstacles: Vec::new(),
            goal_heading: Some(-1.0),
            ..driven()
        };
        let plan = plan(&problem, &Options::default()).unwrap();
        assert_eq!(faults(&problem, &plan), [""; 0], "{distance}");
    }
    let _ = board();
}
