//! Problems in which the robot may drive backwards.

use core::f64::consts::PI;

use geometry::pose::Pose2;
use nalgebra::Point2;
use trajectory::{Method, Plan, PlanError, Problem, RobotLimits};

use crate::problems::{board, disc, faults, motors, options, plan};

/// A goal straight behind a robot that turns slowly: 0.15 m at 0.15 m/s and 0.1 rad/s.
fn behind() -> Problem {
    Problem {
        start: Pose2::new(2.4, 1.8, 0.0),
        goal: Point2::new(2.25, 1.8),
        limits: RobotLimits::simple(0.15, 0.1),
        ..board()
    }
}

/// A turning radius of 0.5 m and a goal to the side: 9.995352 s with reversing, and forwards 12.828813 s with
/// a turn on the spot, a quarter circle and a line.
fn slow(goal_heading: Option<f64>) -> Problem {
    let k = 0.0075;
    Problem {
        start: Pose2::new(306.704 * k, 155.309 * k, 1.6442),
        goal: Point2::new(150.887 * k, 70.365 * k),
        goal_heading,
        limits: RobotLimits::simple(0.15, 0.3),
        ..board()
    }
}

fn is_forwards(plan: &Plan) -> bool {
    plan.samples.iter().all(|sample| sample.v >= 0.0)
}

#[test]
fn a_goal_behind_is_reached_backwards() {
    for method in Method::ALL {
        let problem = behind();
        let plan = plan(&problem, &options(method)).unwrap();
        assert_eq!(faults(&problem, &plan), [""; 0], "{method:?}");
        assert!((plan.final_time - 1.0).abs() < 1e-6, "{}", plan.final_time);
        assert!(plan.gap() < 1e-6, "{}", plan.gap());
    }
}

#[test]
fn a_goal_behind_is_reached_forwards_if_the_robot_must_not_reverse() {
    let mut problem = behind();
    problem.limits = problem.limits.forwards();
    let plan = plan(&problem, &options(Method::Bspline)).unwrap();
    assert_eq!(faults(&problem, &plan), [""; 0]);
    assert!(plan.final_time > 30.0 && is_forwards(&plan));
}

#[test]
fn a_robot_that_is_slower_backwards_takes_the_faster_direction() {
    let time = |v_min: f64| {
        let mut problem = behind();
        problem.limits.v_min = v_min;
        let plan = plan(&problem, &options(Method::Bspline)).unwrap();
        assert_eq!(faults(&problem, &plan), [""; 0], "{v_min}");
        (plan.final_time, is_forwards(&plan))
    };
    assert!((time(-0.05).0 - 3.0).abs() < 1e-6);
    // 500 s backwards.
    assert!(time(-0.0003).0 < 33.0);
}

#[test]
fn a_robot_turned_around_with_its_speeds_exchanged_has_the_same_plan_backwards() {
    let ahead = Problem {
        start: Pose2::new(1.0, 1.0, 0.4),
        goal: Point2::new(3.6, 2.2),
        goal_heading: Some(0.9),
        limits: RobotLimits::simple(0.15, 0.5),
        obstacles: vec![disc(2.2, 1.6, 0.3)],
        ..board()
    };
    let turned = Problem {
        start: Pose2::new(1.0, 1.0, 0.4 - PI),
        goal_heading: Some(0.9 + PI),
        ..ahead.clone()
    };
    let plans = [ahead, turned].map(|problem| {
        let plan = plan(&problem, &options(Method::Bspline)).unwrap();
        assert_eq!(faults(&problem, &plan), [""; 0]);
        plan
    });
    assert!((plans[0].final_time - plans[1].final_time).abs() < 1e-6);
    assert!(is_forwards(&plans[0]) && !is_forwards(&plans[1]));
}

#[test]
fn a_robot_that_rolls_backwards_stops_before_it_drives_ahead() {
    let problem = Problem {
        start: Pose2::new(1.0, 1.0, 0.4),
        start_speed: Some(-0.15),
        start_turn_rate: Some(0.3),
        limits: RobotLimits {
            v_min: -0.22,
            ..motors()
        },
        ..board()
    };
    for method in Method::ALL {
        let plan = plan(&problem, &options(method)).unwrap();
        assert_eq!(faults(&problem, &plan), [""; 0], "{method:?}");
        // It needs 0.3 s to stop.
        assert!(plan.samples.iter().all(|s| s.t >= 0.299 || s.v < 0.0));
    }
}

#[test]
fn a_speed_backwards_beyond_the_limits_is_refused() {
    let refused = |change: fn(&mut Problem)| {
        let mut problem = behind();
        problem.limits.v_min = -0.1;
        change(&mut problem);
        match plan(&problem, &options(Method::Bspline)) {
            Err(PlanError::Invalid(e)) => e.to_string(),
            other => panic!("{other:?}"),
        }
    };
    let range = "expected from -0.1 to 0.15 by the limits";
    assert_eq!(
        refused(|p| p.start_speed = Some(-0.11)),
        format!("start_speed = -0.11: {range}")
    );
    assert_eq!(
        refused(|p| p.goal_speed = Some(-0.11)),
        format!("goal_speed = -0.11: {range}")
    );
    assert_eq!(
        refused(|p| p.limits.v_min = 0.1),
        "v_min = 0.1: expected a number from -0.15 to 0"
    );
    assert_eq!(
        refused(|p| p.limits.v_min = -0.2),
        "v_min = -0.2: expected a number from -0.15 to 0"
    );
    assert!(refused(|p| p.limits.v_min = f64::NAN).starts_with("v_min"));
}

#[test]
fn where_turning_is_slow_and_nothing_is_near_the_plan_is_the_fastest_motion() {
    for (reverse, expected) in [(true, 9.995_352), (false, 12.828_813)] {
        let mut problem = slow(None);
        if !reverse {
            problem.limits = problem.limits.forwards();
        }
        let plan = plan(&problem, &options(Method::Bspline)).unwrap();
        assert_eq!(faults(&problem, &plan), [""; 0]);
        assert!(
            (plan.final_time - expected).abs() < 1e-5,
            "{}",
            plan.final_time
        );
        assert!(plan.gap() < 1e-6, "{}", plan.gap());
        assert!(reverse || is_forwards(&plan));
    }
}
