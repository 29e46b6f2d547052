//! Invalid input: errors name the field, and there is never a wrong result.

use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;
use trajectory::{Method, Options, PlanError, Problem, Wheels};

use crate::problems::{board, cluttered, disc, faults, options, plan};

fn refused(problem: &Problem, field: &str) {
    for method in Method::ALL {
        match plan(problem, &options(method)) {
            Err(PlanError::Invalid(e)) => assert_eq!(e.field, field, "{e}"),
            other => panic!("{field}: {other:?}"),
        }
    }
}

#[test]
fn numbers_out_of_range_are_refused_by_name() {
    type Change = fn(&mut Problem, f64);
    let all: [(&str, Change); 9] = [
        ("start.x", |p, v| p.start.x = v),
        ("start.y", |p, v| p.start.y = v),
        ("start.theta", |p, v| p.start.theta = v),
        ("goal.x", |p, v| p.goal.x = v),
        ("goal.theta", |p, v| p.goal_heading = Some(v)),
        ("start_speed", |p, v| p.start_speed = Some(v)),
        ("goal_speed", |p, v| p.goal_speed = Some(v)),
        ("bounds.max.x", |p, v| p.bounds.max.x = v),
        ("obstacles[1].radius", |p, v| {
            p.obstacles[1] = disc(1.0, 1.0, v);
        }),
    ];
    for (field, change) in all {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            let mut problem = cluttered();
            change(&mut problem, value);
            refused(&problem, field);
        }
    }
    let limits: [(&str, Change); 6] = [
        ("v_max", |p, v| p.limits.v_max = v),
        ("omega_max", |p, v| p.limits.omega_max = v),
        ("acceleration", |p, v| p.limits.acceleration = Some(v)),
        ("angular_acceleration", |p, v| {
            p.limits.angular_acceleration = Some(v);
        }),
        ("clearance", |p, v| p.clearance = v),
        ("wheel_speed", |p, v| {
            p.limits.wheels = Some(Wheels {
                speed: v,
                separation: 0.1,
            });
        }),
    ];
    for (field, change) in limits {
        for value in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
            let mut problem = cluttered();
            change(&mut problem, value);
            refused(&problem, field);
        }
    }
}

#[test]
fn a_speed_beyond_the_limits_is_refused() {
    let mut problem = cluttered();
    problem.start_speed = Some(0.2);
    refused(&problem, "start_speed");
    problem.start_speed = None;
    problem.goal_speed = Some(0.2);
    refused(&problem, "goal_speed");
    problem.goal_speed = None;
    problem.start_turn_rate = Some(-17.0);
    refused(&problem, "start_turn_rate");
}

#[test]
fn bounds_without_an_inside_are_refused() {
    let mut problem = board();
    problem.bounds = Aabb {
        min: Point2::new(1.0, 0.0),
        max: Point2::new(1.0, 2.0),
    };
    refused(&problem, "bounds");
}

#[test]
fn polygons_without_corners_are_refused() {
    let mut problem = board();
    problem.obstacles = vec![Convex::polygon(&[
        Point2::new(1.0, 1.0),
        Point2::new(1.0, 1.0),
    ])];
    refused(&problem, "obstacles[0]");
}

#[test]
fn options_out_of_range_are_refused_by_name() {
    let ok = Options::default();
    let all = [
        (
            "degree",
            Options {
                degree: Some(1),
                ..ok
            },
        ),
        (
            "degree",
            Options {
                degree: Some(9),
                ..ok
            },
        ),
        (
            "control_points",
            Options {
                control_points: Some(3),
                ..ok
            },
        ),
        (
            "control_points",
            Options {
                control_points: Some(100_000),
                ..ok
            },
        ),
        (
            "nodes",
            Options {
                nodes: Some(0),
                ..ok
            },
        ),
        (
            "nodes",
            Options {
                nodes: Some(1_000_000),
                ..ok
            },
        ),
        (
            "reference_point",
            Options {
                reference_point: Some([f64::NAN, 0.0]),
                ..ok
            },
        ),
    ];
    for (field, options) in all {
        match plan(&board(), &options) {
            Err(PlanError::Invalid(e)) => assert_eq!(e.field, field),
            other => panic!("{field}: {other:?}"),
        }
    }
}

#[test]
fn a_reference_point_at_the_start_still_gives_a_plan() {
    let options = Options {
        reference_point: Some([board().start.x, board().start.y]),
        ..options(Method::Vmc)
    };
    let plan = plan(&cluttered(), &options).unwrap();
    assert_eq!(faults(&cluttered(), &plan), [""; 0]);
}

#[test]
fn five_hundred_obstacles_are_a_problem_like_any_other() {
    let mut problem = board();
    let place = |i: usize| {
        let (col, row) = ((i % 25) as f64, (i / 25) as f64);
        disc(0.3 + 0.18 * col, 0.25 + 0.165 * row, 0.005)
    };
    problem.obstacles = (0..500).map(place).collect();
    problem.clearance = 0.04;
    for method in [Method::Bspline, Method::Tangent] {
        let plan = plan(&problem, &options(method)).unwrap();
        assert_eq!(faults(&problem, &plan), [""; 0], "{method:?}");
    }
}

#[test]
fn more_obstacles_than_allowed_are_refused() {
    let mut problem = board();
    problem.obstacles = vec![disc(3.0, 3.0, 0.01); 5000];
    refused(&problem, "obstacles");
}

#[test]
fn endless_spinning_or_rolling_is_infeasible() {
    // Found by fuzzing: a trajectory of 10¹⁷ samples.
    let mut spinning = cluttered();
    spinning.limits.omega_max = 1e6;
    spinning.limits.angular_acceleration = Some(1e-6);
    spinning.start_turn_rate = Some(1e6);
    let mut rolling = board();
    rolling.limits.acceleration = Some(1e-9);
    rolling.limits.v_max = 1e3;
    rolling.start_speed = Some(1e3);
    rolling.bounds.min = Point2::new(-1e6, -1e6);
    rolling.bounds.max = Point2::new(1e6, 1e6);
    let mut far = rolling.clone();
    far.goal = Point2::new(1e6, 1e6);
    far.start_speed = None;
    // So slow that a step of the search would take hours.
    let mut slow = cluttered();
    (slow.limits.v_max, slow.limits.v_min) = (1e-5, -1e-5);
    slow.limits.acceleration = Some(1.0);
    slow.limits.angular_acceleration = Some(1.0);
    for method in Method::ALL {
        for problem in [&spinning, &rolling, &far] {
            match plan(problem, &options(method)) {
                Err(PlanError::Infeasible(_)) => {}
                other => panic!("{method:?}: {other:?}"),
            }
        }
        let plan = plan(&slow, &options(method)).unwrap();
        assert_eq!(faults(&slow, &plan), [""; 0], "{method:?}");
    }
}

/// Its arcs are so long that their points would not fit into the memory.
#[test]
fn a_robot_that_hardly_turns_is_planned_like_any_other() {
    for omega_max in [1e-6, 1e-12, 1e-300, 3e-322] {
        for reverse in [0.0, 1.0] {
            let mut problem = cluttered();
            problem.limits.omega_max = omega_max;
            problem.limits.v_min = -reverse * problem.limits.v_max;
            if let Ok(found) = plan(&problem, &options(Method::Bspline)) {
                assert_eq!(faults(&problem, &found), [""; 0], "{omega_max}");
            }
        }
    }
}
