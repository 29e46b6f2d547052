//! Every method on the paper's robot.

use core::f64::consts::{FRAC_PI_3, TAU};

use geometry::shape::Convex;
use nalgebra::Point2;
use trajectory::{Method, Options, PlanError, Problem, Status};
use trajectory_problem::{Constraints, Guess};

use crate::problems::{board, cluttered, disc, faults, motors, options, plan};

#[test]
fn every_method_finds_a_valid_plan_near_the_bound() {
    let problem = cluttered();
    for method in Method::ALL {
        let plan = plan(&problem, &options(method)).unwrap();
        assert_eq!(faults(&problem, &plan), [""; 0], "{method:?}");
        assert_eq!((plan.status, plan.method), (Status::Planned, method));
        assert!(plan.gap() < 3e-3, "{method:?}: {}", plan.gap());
        assert!(plan.min_clearance > -1e-3 && plan.min_clearance < 0.01);
    }
}

#[test]
fn the_bound_is_the_exact_shortest_path_at_full_speed() {
    // Around a circle of radius 1 from twice as far: 2√3 + π/3.
    let mut problem = Problem {
        goal: Point2::new(4.4, 1.8),
        obstacles: vec![disc(2.4, 1.8, 0.9)],
        clearance: 0.1,
        ..board()
    };
    (problem.start.x, problem.start.y, problem.start.theta) = (0.4, 1.8, 0.0);
    let shortest = 2.0 * 3f64.sqrt() + FRAC_PI_3;
    let found = plan(&problem, &Options::default()).unwrap();
    assert!((found.lower_bound - shortest / 0.15).abs() < 1e-9);
    assert!(
        found.gap() < 5e-4,
        "{} {} {} {} {}",
        found.gap(),
        found.length / shortest - 1.0,
        found.min_clearance,
        found.iterations,
        found.control_points
    );
    let tangent = plan(&problem, &options(Method::Tangent)).unwrap();
    // The tangent begins at 30°, to either side.
    let turn = core::f64::consts::PI / 6.0;
    assert!((tangent.final_time - (shortest / 0.15 + turn / 16.0)).abs() < 1e-9);
}

#[test]
fn the_same_problem_gives_the_same_plan() {
    for method in Method::ALL {
        let first = plan(&cluttered(), &options(method)).unwrap();
        assert_eq!(plan(&cluttered(), &options(method)).unwrap(), first);
    }
}

#[test]
fn without_obstacles_the_path_is_nearly_straight() {
    for method in Method::ALL {
        let plan = plan(&board(), &options(method)).unwrap();
        assert_eq!(faults(&board(), &plan), [""; 0]);
        assert!(plan.gap() < 2e-4 && plan.min_clearance == f64::INFINITY);
    }
}

#[test]
fn a_goal_behind_the_robot_begins_with_a_turn() {
    let mut problem = cluttered();
    problem.start.theta += core::f64::consts::PI;
    for method in Method::ALL {
        let plan = plan(&problem, &options(method)).unwrap();
        assert_eq!(faults(&problem, &plan), [""; 0], "{method:?}");
        assert!(plan.gap() < 0.01);
    }
}

#[test]
fn a_wall_without_a_gap_is_no_path() {
    let mut problem = board();
    problem.obstacles = (0..9)
        .map(|i| disc(2.4, 0.45 * f64::from(i), 0.2))
        .collect();
    for method in Method::ALL {
        assert_eq!(plan(&problem, &options(method)), Err(PlanError::NoPath));
    }
}

#[test]
fn the_wavefront_is_a_start_as_well() {
    let wavefront = Options {
        guess: Guess::Wavefront,
        ..Options::default()
    };
    let found = plan(&cluttered(), &wavefront).unwrap();
    assert_eq!(faults(&cluttered(), &found), [""; 0]);
    assert!(found.gap() < 0.05);
}

#[test]
fn nodes_do_not_see_what_lies_between_them() {
    let strict = |constraints| Options {
        constraints,
        fallbacks: false,
        control_points: Some(8),
        degree: Some(4),
        ..options(Method::Vmc)
    };
    // Small discs, between the nodes.
    let mut problem = board();
    problem.obstacles = (1..9)
        .map(|i| disc(0.53 * f64::from(i), 0.39 * f64::from(i) + 0.03, 0.04))
        .collect();
    let blind = plan(&problem, &strict(Constraints::Nodes));
    assert_eq!(blind, Err(PlanError::InvalidTrajectory));
    let dense = plan(&problem, &strict(Constraints::Dense)).unwrap();
    assert_eq!(faults(&problem, &dense), [""; 0]);
}

#[test]
fn control_points_and_degree_are_those_asked_for() {
    for (method, degree, count) in [
        (Method::Bspline, 3, 12),
        (Method::Lp, 4, 8),
        (Method::Vmc, 6, 14),
    ] {
        let asked = Options {
            degree: Some(degree),
            control_points: Some(count),
            fallbacks: false,
            ..options(method)
        };
        let mut problem = cluttered();
        problem.obstacles.truncate(2);
        let plan = plan(&problem, &asked).unwrap();
        assert_eq!(plan.control_points, count as u32);
        // Few points of a high degree must not oscillate between the tested points.
        assert!(plan.gap() < 0.02, "{method:?}: {}", plan.gap());
        assert_eq!(faults(&problem, &plan), [""; 0]);
    }
}

#[test]
fn a_stopped_search_returns_the_fallback_plan() {
    let mut asked = 0;
    let found = trajectory::plan(&cluttered(), &options(Method::Vmc), None, &mut || {
        asked += 1;
        true
    })
    .unwrap();
    assert!(asked > 0);
    assert_eq!(found.status, Status::Deadline);
    assert_eq!(faults(&cluttered(), &found), [""; 0]);
}

#[test]
fn start_and_goal_in_one_place_take_no_time_or_a_turn() {
    let mut problem = board();
    problem.goal = problem.start.position();
    for method in Method::ALL {
        let still = plan(&problem, &options(method)).unwrap();
        assert_eq!((still.final_time, still.gap()), (0.0, 0.0));
        assert_eq!(still.status, Status::Planned);
        let turned = Problem {
            goal_heading: Some(problem.start.theta + TAU / 4.0),
            ..problem.clone()
        };
        let turn = plan(&turned, &options(method)).unwrap();
        assert!((turn.final_time - TAU / 4.0 / 16.0).abs() < 1e-12);
        assert_eq!(faults(&turned, &turn), [""; 0]);
    }
}

#[test]
fn the_last_plan_is_a_start_for_the_next() {
    let problem = cluttered();
    let first = plan(&problem, &Options::default()).unwrap();
    let middle = first.samples[first.samples.len() / 3];
    let mut next = problem.clone();
    (next.start.x, next.start.y, next.start.theta) = (middle.x, middle.y, middle.theta);
    next.obstacles.push(disc(4.4, 0.8, 0.1));
    let cold = plan(&next, &Options::default()).unwrap();
    let warm = trajectory::plan(&next, &Options::default(), Some(&first), &mut || false).unwrap();
    assert_eq!(faults(&next, &warm), [""; 0]);
    assert!(warm.iterations <= cold.iterations);
    assert!((warm.final_time / cold.final_time - 1.0).abs() < 1e-3);
}

/// The board with a wall that has a gap of this width (m) on the straight way, and another one far
/// away from it.
fn walled(gap: f64) -> Problem {
    let wall = |from: f64, to: f64| {
        let middle = Point2::new(2.4, f64::midpoint(from, to));
        Convex::rectangle(middle, [0.1, 0.5 * (to - from)], 0.0)
    };
    Problem {
        obstacles: vec![wall(0.4, 1.78), wall(1.78 + gap, 3.6), disc(4.0, 2.7, 0.1)],
        ..board()
    }
}

#[test]
fn a_last_plan_through_a_gap_that_has_closed_costs_nothing() {
    let first = plan(&walled(0.2), &Options::default()).unwrap();
    // The robot does not fit any more, but the path is hardly deeper than the clearance.
    let closed = walled(0.14);
    let cold = plan(&closed, &Options::default()).unwrap();
    let warm = trajectory::plan(&closed, &Options::default(), Some(&first), &mut || false).unwrap();
    assert!(cold.length > first.length + 0.1);
    assert_eq!(warm, cold);
}

#[test]
fn the_work_of_a_plan_has_a_limit_and_ends_at_the_same_point_every_time() {
    let problem = Problem {
        limits: motors(),
        start_speed: Some(0.0),
        start_turn_rate: Some(0.0),
        goal_speed: Some(0.0),
        ..cluttered()
    };
    let whole = plan(&problem, &Options::default()).unwrap();
    for share in [0, 1, 2, 4, 8, 16] {
        let options = Options {
            max_work: Some(whole.work * share / 16),
            ..Options::default()
        };
        let part = plan(&problem, &options).unwrap();
        assert_eq!(plan(&problem, &options).unwrap(), part);
        assert_eq!(faults(&problem, &part), [""; 0]);
        assert!(part.work <= whole.work);
        assert!(matches!(part.status, Status::Planned | Status::Fallback));
        // The last program begins before the limit.
        let mean = whole.work / u64::from(whole.iterations);
        assert!(part.work <= whole.work * share / 16 + 8 * mean, "{part:?}");
    }
}
