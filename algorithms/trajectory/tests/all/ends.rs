//! Starts and goals at obstacles, and prescribed headings and speeds.

use geometry::shape::Convex;
use nalgebra::Point2;
use trajectory::{Method, PlanError, Problem, Wheels};

use crate::problems::{board, cluttered, disc, faults, options, plan};

/// A start at a distance from a grown disc that blocks the straight path.
fn at_disc(depth: f64) -> Problem {
    let mut problem = board();
    (problem.start.x, problem.start.y, problem.start.theta) = (1.0, 1.8, 0.4);
    problem.goal = Point2::new(4.0, 1.8);
    let radius = 0.2;
    let away = radius + problem.clearance - depth;
    problem.obstacles = vec![disc(1.0 + away, 1.8, radius)];
    problem
}

#[test]
fn a_start_on_the_border_of_an_obstacle_is_free() {
    // Replanning creates this case: the old path runs along the border of the obstacles that it
    // passes.
    for depth in [0.0, 1e-12, -1e-12, 1e-8, -1e-8] {
        for method in Method::ALL {
            let problem = at_disc(depth);
            let plan = plan(&problem, &options(method)).unwrap();
            assert_eq!(faults(&problem, &plan), [""; 0], "{method:?} {depth}");
            // Around the disc from the point of contact.
            assert!(
                plan.lower_bound > 3.0 / 0.15 && plan.gap() < 0.012,
                "{}",
                plan.gap()
            );
        }
    }
}

#[test]
fn a_start_inside_by_the_tracking_error_is_accepted() {
    let boxed = {
        let mut problem = at_disc(0.0);
        let edge = 1.0 + problem.clearance - 0.003;
        problem.obstacles = vec![Convex::rectangle(
            Point2::new(edge + 0.1, 1.8),
            [0.1, 0.3],
            0.0,
        )];
        problem
    };
    for problem in [at_disc(0.004), boxed] {
        for method in Method::ALL {
            let plan = plan(&problem, &options(method)).unwrap();
            let grown = Problem {
                clearance: problem.clearance - 0.004,
                ..problem.clone()
            };
            assert_eq!(faults(&grown, &plan), [""; 0], "{method:?}");
        }
    }
}

#[test]
fn a_start_deeper_inside_is_refused() {
    match plan(&at_disc(0.006), &options(Method::Bspline)) {
        Err(PlanError::Invalid(e)) => {
            assert_eq!(e.field, "start");
            assert!(e.to_string().contains("obstacles[0]"), "{e}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_goal_in_an_obstacle_or_beyond_the_bounds_is_refused() {
    let blocked = Problem {
        goal: Point2::new(2.0, 1.4),
        ..cluttered()
    };
    let outside = Problem {
        goal: Point2::new(5.0, 1.4),
        ..cluttered()
    };
    for problem in [blocked, outside] {
        match plan(&problem, &options(Method::Lp)) {
            Err(PlanError::Invalid(e)) => assert_eq!(e.field, "goal"),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn headings_at_the_goal_are_kept() {
    for heading in [0.0, 0.8, 1.6, 3.1, -2.0] {
        let problem = Problem {
            goal_heading: Some(heading),
            goal_speed: Some(0.0),
            start_speed: Some(0.1),
            ..cluttered()
        };
        for method in Method::ALL {
            let plan = plan(&problem, &options(method)).unwrap();
            assert_eq!(faults(&problem, &plan), [""; 0], "{method:?} {heading}");
            assert!(plan.gap() < 0.02, "{method:?} {heading}: {}", plan.gap());
        }
    }
}

#[test]
fn wheels_slow_bends_down() {
    let mut problem = cluttered();
    let free = plan(&problem, &options(Method::Bspline)).unwrap();
    problem.limits.wheels = Some(Wheels {
        speed: 0.15,
        separation: 0.16,
    });
    for method in Method::ALL {
        let plan = plan(&problem, &options(method)).unwrap();
        assert_eq!(faults(&problem, &plan), [""; 0], "{method:?}");
        assert!(plan.final_time > free.final_time);
    }
}
