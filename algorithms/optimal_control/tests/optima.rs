//! Searches whose results are known, and their symmetries.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use core::f64::consts::PI;

use geometry::math;
use geometry::shape::{Aabb, Convex};
use nalgebra::{Point2, Rotation2, Vector2};
use optimal_control::{COARSE, KeepOutDisc, Node, Problem, Search, Solution};
use proptest::prelude::*;
use trajectory_problem::{RobotLimits, Wheels};

const LIMITS: RobotLimits = RobotLimits {
    v_max: 0.5,
    v_min: 0.0,
    omega_max: 1.0,
    wheels: None,
    acceleration: Some(0.5),
    angular_acceleration: Some(2.0),
};

fn open(goal: Point2<f64>, limits: RobotLimits) -> Problem<'static> {
    let far = Vector2::repeat(100.0);
    Problem {
        start: Point2::origin(),
        start_heading: 0.0,
        start_speeds: [Some(0.0), Some(0.0)],
        goal,
        goal_heading: None,
        goal_speed: Some(0.0),
        limits,
        bounds: Aabb {
            min: Point2::origin() - far,
            max: Point2::origin() + far,
        },
        obstacles: Vec::new(),
    }
}

/// A straight guess at a speed.
fn straight(problem: &Problem<'_>, v: f64) -> (Vec<Node>, f64) {
    let way = problem.goal - problem.start;
    let node = |k: usize| Node {
        at: problem.start + way * (k as f64 / COARSE as f64),
        theta: problem.start_heading,
        v,
        omega: 0.0,
    };
    ((0..=COARSE).map(node).collect(), way.norm() / v.abs())
}

fn solve(problem: &Problem<'_>, v: f64) -> Solution {
    let (guess, duration) = straight(problem, v);
    let mut search = Search::new(problem, &guess, duration).unwrap();
    let outcome = search.run(&mut |_| false);
    assert!(outcome.is_optimal(), "{outcome:?}");
    search.solution()
}

#[test]
fn a_straight_motion_is_a_trapezoid_of_speeds() {
    let problem = open(Point2::new(3.0, 0.0), LIMITS);
    // 1 s up over 0.25 m, 5 s at full speed, 1 s down.
    let solution = solve(&problem, 0.4);
    assert!(
        (solution.duration - 7.0).abs() < 1e-3,
        "{}",
        solution.duration
    );
}

#[test]
fn a_goal_behind_is_reached_backwards() {
    let problem = open(
        Point2::new(-3.0, 0.0),
        RobotLimits {
            v_min: -0.5,
            ..LIMITS
        },
    );
    let solution = solve(&problem, -0.4);
    assert!(
        (solution.duration - 7.0).abs() < 1e-3,
        "{}",
        solution.duration
    );
    assert!(solution.nodes.iter().all(|node| node.v < 1e-6));
}

#[test]
fn without_inertia_the_path_is_an_arc_and_a_straight_line() {
    let limits = RobotLimits {
        acceleration: None,
        angular_acceleration: None,
        ..LIMITS
    };
    let mut problem = open(Point2::new(1.0, 1.0), limits);
    (problem.start_speeds, problem.goal_speed) = ([None, None], None);
    let solution = solve(&problem, 0.5);
    // Turning radius 0.5 m: the tangent from the goal to the circle about (0, 0.5).
    let reach = (1.25f64 - 0.25).sqrt();
    let turn = math::atan2(0.5, 1.0) + PI / 2.0 - math::atan2(reach, 0.5);
    let shortest = (0.5 * turn + reach) / 0.5;
    assert!(solution.steps);
    assert!(
        (solution.duration / shortest - 1.0).abs() < 1e-3,
        "{} {shortest}",
        solution.duration
    );
}

#[test]
fn wheels_limit_both_speeds_together() {
    let limits = RobotLimits {
        wheels: Some(Wheels {
            speed: 0.5,
            separation: 0.4,
        }),
        ..LIMITS
    };
    let solution = solve(&open(Point2::new(1.0, 1.0), limits), 0.4);
    for node in &solution.nodes {
        assert!(node.v + 0.2 * node.omega.abs() < 0.5 + 1e-6);
    }
}

#[test]
fn a_guess_without_stages_or_duration_is_none() {
    let problem = open(Point2::new(1.0, 1.0), LIMITS);
    let (guess, duration) = straight(&problem, 0.4);
    assert!(Search::new(&problem, &guess[..1], duration).is_none());
    for duration in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Search::new(&problem, &guess, duration).is_none());
    }
}

#[test]
fn a_stop_ends_the_search() {
    let problem = open(Point2::new(1.0, 1.0), LIMITS);
    let (guess, duration) = straight(&problem, 0.4);
    let mut search = Search::new(&problem, &guess, duration).unwrap();
    let mut calls = 0;
    let mut stop = |_| {
        calls += 1;
        calls > 2
    };
    assert!(!search.run(&mut stop).is_optimal());
}

/// A problem around a disc, with a guess on one side of it.
fn around(disc: &Convex, scale: f64, turned: Rotation2<f64>) -> (Problem<'_>, Vec<Node>, f64) {
    let mut problem = open(
        Point2::from(turned * Vector2::new(2.0, 0.0)) * scale,
        LIMITS,
    );
    problem.limits.v_max *= scale;
    problem.limits.acceleration = Some(0.5 * scale);
    problem.start_heading = turned.angle();
    problem.obstacles.push(KeepOutDisc {
        shape: disc,
        distance: 0.1 * scale,
    });
    let node = |k: usize| {
        let part = k as f64 / COARSE as f64;
        Node {
            at: Point2::from(turned * Vector2::new(2.0 * part, -0.3)) * scale,
            theta: turned.angle(),
            v: 0.4 * scale,
            omega: 0.0,
        }
    };
    (problem, (0..=COARSE).map(node).collect(), 5.0)
}

fn duration(problem: &Problem<'_>, guess: &[Node], time: f64) -> f64 {
    let mut search = Search::new(problem, guess, time).unwrap();
    let outcome = search.run(&mut |_| false);
    assert!(outcome.is_optimal(), "{outcome:?}");
    search.duration()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Lengths in other units, a turn of the plane, and times in other units change nothing but what
    /// they must.
    #[test]
    fn scales_and_turns_of_the_plane_change_nothing(
        scale in 0.1..10.0f64, angle in -PI..PI, slower in 0.2..5.0f64, y in -0.05..0.2f64,
    ) {
        let disc = Convex::disc(Point2::new(1.0, y), 0.2);
        let (problem, guess, time) = around(&disc, 1.0, Rotation2::identity());
        let plain = duration(&problem, &guess, time);
        let turned = Rotation2::new(angle);
        let moved = Convex::disc(Point2::from(turned * Vector2::new(1.0, y)) * scale, 0.2 * scale);
        let (mut problem, mut guess, time) = around(&moved, scale, turned);
        problem.limits.v_max /= slower;
        problem.limits.omega_max /= slower;
        problem.limits.acceleration = problem.limits.acceleration.map(|a| a / (slower * slower));
        problem.limits.angular_acceleration = Some(2.0 / (slower * slower));
        for node in &mut guess {
            node.v /= slower;
        }
        let other = duration(&problem, &guess, time * slower) / slower;
        prop_assert!((other / plain - 1.0).abs() < 1e-5, "{plain} {other}");
    }

    /// The mirror image of a problem has the mirror image's duration, and the way back takes as long.
    #[test]
    fn mirroring_and_reversing_change_nothing(y in 0.0..0.2f64, r in 0.1..0.3f64) {
        let disc = Convex::disc(Point2::new(0.9, y), r);
        let (problem, guess, time) = around(&disc, 1.0, Rotation2::identity());
        let plain = duration(&problem, &guess, time);
        let mirrored = Convex::disc(Point2::new(0.9, -y), r);
        let (problem, mut guess, time) = around(&mirrored, 1.0, Rotation2::identity());
        for node in &mut guess {
            node.at.y = -node.at.y;
        }
        let other = duration(&problem, &guess, time);
        prop_assert!((other / plain - 1.0).abs() < 1e-6, "mirrored {plain} {other}");
        // Backwards from the goal: both ends must be prescribed alike.
        let (mut problem, guess, time) = around(&disc, 1.0, Rotation2::identity());
        problem.goal_heading = Some(0.0);
        problem.start_speeds = [Some(0.0), None];
        let there = duration(&problem, &guess, time);
        (problem.start, problem.goal) = (problem.goal, problem.start);
        (problem.limits.v_min, problem.limits.v_max) = (-0.5, 0.0);
        let back: Vec<Node> = guess.iter().rev().map(|node| Node { v: -node.v, ..*node }).collect();
        let back = duration(&problem, &back, time);
        prop_assert!((back / there - 1.0).abs() < 1e-5, "reversed {there} {back}");
    }

    /// An obstacle that the plan does not touch changes nothing.
    #[test]
    fn an_obstacle_beside_the_path_changes_nothing(x in 0.2..1.8f64, r in 0.05..0.2f64) {
        let disc = Convex::disc(Point2::new(1.0, 0.1), 0.2);
        let (mut problem, guess, time) = around(&disc, 1.0, Rotation2::identity());
        let plain = duration(&problem, &guess, time);
        let beside = Convex::disc(Point2::new(x, 0.75), r);
        problem.obstacles.push(KeepOutDisc { shape: &beside, distance: 0.1 });
        let other = duration(&problem, &guess, time);
        prop_assert!((other / plain - 1.0).abs() < 2e-5, "{plain} {other}");
    }
}

#[test]
fn a_search_that_leaves_its_guess_keeps_away_from_what_it_comes_to() {
    // A robot that turns within 84 px swings out by far more than the way to its goal, around a disc there.
    let disc = Convex::disc(Point2::new(331.702, 208.476), 19.913);
    let problem = Problem {
        start: Point2::new(440.406, 136.724),
        start_heading: -1.606_473,
        start_speeds: [None, None],
        goal_heading: Some(0.98582),
        goal_speed: None,
        bounds: Aabb {
            min: Point2::origin(),
            max: Point2::new(640.0, 480.0),
        },
        obstacles: vec![KeepOutDisc {
            shape: &disc,
            distance: 10.0,
        }],
        ..open(
            Point2::new(361.213, 252.038),
            RobotLimits::simple(20.0, 0.2374).forwards(),
        )
    };
    let way = problem.goal - problem.start;
    let direction = math::atan2(way.y, way.x);
    let into = math::angle_difference(direction, problem.start_heading);
    let out = math::angle_difference(0.98582, direction);
    let guess: Vec<Node> = (0..=COARSE)
        .map(|k| {
            let part = k as f64 / COARSE as f64;
            let left = |part: f64| (1.0 - 2.0 * part).max(0.0);
            let theta = problem.start_heading + into * (1.0 - left(part)) + out * left(1.0 - part);
            Node {
                at: problem.start + way * part,
                theta,
                v: 20.0,
                omega: 0.0,
            }
        })
        .collect();
    let mut search = Search::new(&problem, &guess, way.norm() / 20.0).unwrap();
    let outcome = search.run_coarse(&mut |_| false);
    assert!(outcome.residual < 1e-3, "{outcome:?}");
    assert!(search.duration() < 16.5, "{}", search.duration());
    for node in search.solution().nodes {
        let distance = (node.at - Point2::new(331.702, 208.476)).norm();
        assert!(distance > 29.9, "{distance}");
    }
}
