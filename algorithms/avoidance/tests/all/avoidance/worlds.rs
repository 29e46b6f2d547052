//! Worlds that trap robots: walls, pockets, spirals, mazes, and goals behind closed walls.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::drive::{Machine, PATROL, Run, square, wall};
use avoidance::tangent_bug::{Advice, Mode, TangentBug};
use geometry::math;
use geometry::pose::Pose2;
use geometry::shape::Convex;
use nalgebra::Point2;
use planner_view::view::ScanView;
use planner_view::waypoint::WaypointOutcome::{self, Reached, Unreachable};

fn p(x: f64, y: f64) -> Point2<f64> {
    Point2::new(x, y)
}

/// Drives from a point to a point; asserts that there is no contact, and returns the outcome.
fn outcome_of(machine: Machine, parts: Vec<Convex>, from: Point2<f64>, to: Point2<f64>) -> Run {
    let pose = Pose2::new(from.x, from.y, 0.4);
    let mut run = Run::new(machine, square(6.0, parts), pose, machine.driver());
    let outcome = run.go(to, 600.0);
    assert!(
        outcome.is_some(),
        "neither reached nor given up from {from} to {to}: at {:?}",
        run.pose
    );
    assert!(
        run.least_clearance > 0.0,
        "contact: {}",
        run.least_clearance
    );
    run
}

fn check(parts: Vec<Convex>, from: Point2<f64>, to: Point2<f64>, expected: WaypointOutcome) -> f64 {
    let run = outcome_of(PATROL, parts, from, to);
    assert_eq!(run.reports[0].outcome, expected, "from {from} to {to}");
    run.travelled
}

fn turned(point: Point2<f64>, angle: f64) -> Point2<f64> {
    let (sin, cos) = math::sincos(angle);
    p(cos * point.x - sin * point.y, sin * point.x + cos * point.y)
}

/// Walls along a line of points, rotated about the origin.
fn walls(points: &[(f64, f64)], angle: f64) -> Vec<Convex> {
    points
        .windows(2)
        .map(|pair| {
            let [a, b] = [pair[0], pair[1]].map(|(x, y)| turned(p(x, y), angle));
            wall((a.x, a.y), (b.x, b.y), 0.1)
        })
        .collect()
}

#[test]
fn open_ground_is_crossed_straight() {
    let distance = check(vec![], p(-5.0, -5.0), p(5.0, 4.0), Reached);
    assert!(
        distance < 1.02 * (p(-5.0, -5.0) - p(5.0, 4.0)).norm(),
        "{distance}"
    );
}

#[test]
fn convex_obstacles_are_gone_around_by_a_short_way() {
    for offset in [-0.7, -0.3, 0.0, 0.05, 0.6] {
        for size in [0.05, 0.4, 1.0] {
            let disc = Convex::disc(p(0.0, offset * size), size);
            let distance = check(vec![disc], p(-4.0, 0.0), p(4.0, 0.0), Reached);
            assert!(
                distance < 8.0 + 4.5 * (size + 0.2),
                "disc {size} at {offset}: {distance}"
            );
            let block = Convex::rectangle(p(0.0, offset * size), [size, size], 0.3);
            check(vec![block], p(-4.0, 0.0), p(4.0, 0.0), Reached);
        }
    }
}

#[test]
fn traps_are_left_in_every_orientation() {
    for turn in 0..8 {
        let angle = f64::from(turn) * TAU / 8.0 + 0.1;
        let trap = walls(&[(-1.5, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.5, -1.0)], angle);
        check(
            trap.clone(),
            turned(p(0.0, 0.1), angle),
            turned(p(4.0, 0.0), angle),
            Reached,
        );
        check(
            trap,
            turned(p(4.0, 0.3), angle),
            turned(p(0.0, 0.1), angle),
            Reached,
        );
    }
}

fn spiral(angle: f64) -> Vec<Convex> {
    let corners = [
        (3.5, -3.5),
        (3.5, 3.5),
        (-3.5, 3.5),
        (-3.5, -2.6),
        (2.6, -2.6),
        (2.6, 2.6),
        (-2.6, 2.6),
        (-2.6, -1.7),
        (1.7, -1.7),
        (1.7, 1.7),
        (-1.7, 1.7),
        (-1.7, -0.8),
        (0.8, -0.8),
        (0.8, 0.8),
        (-0.8, 0.8),
    ];
    walls(&corners, angle)
}

#[test]
fn the_middle_of_a_spiral_is_reached_and_left() {
    for turn in 0..2 {
        let angle = f64::from(turn) * 2.0;
        let outside = turned(p(5.0, 1.0), angle);
        check(spiral(angle), outside, p(0.0, 0.0), Reached);
        check(spiral(angle), p(0.0, 0.0), outside, Reached);
    }
}

/// A maze of 5 × 5 cells, 2 m wide.
fn maze() -> Vec<Convex> {
    let lines = [
        ((-3.0, -5.0), (-3.0, -1.0)),
        ((-3.0, 1.0), (-3.0, 5.0)),
        ((-1.0, -3.0), (-1.0, 3.0)),
        ((1.0, -5.0), (1.0, -1.0)),
        ((1.0, 1.0), (1.0, 4.8)),
        ((3.0, -3.0), (3.0, 3.0)),
        ((-1.0, -3.0), (1.0, -3.0)),
        ((-6.0, 1.0), (-5.0, 1.0)),
        ((-3.0, -1.0), (-1.0, -1.0)),
        ((3.0, 3.0), (6.0, 3.0)),
        ((1.0, 1.0), (3.0, 1.0)),
        ((-5.0, -3.0), (-3.0, -3.0)),
    ];
    lines.iter().map(|&(a, b)| wall(a, b, 0.1)).collect()
}

#[test]
fn every_cell_of_a_maze_is_reached() {
    let cells = [
        (-4.0, -4.5),
        (-2.0, 4.0),
        (0.0, 0.0),
        (2.0, 2.0),
        (5.0, 5.0),
        (5.0, 0.0),
        (-2.0, -2.0),
    ];
    for (i, &(x, y)) in cells.iter().enumerate() {
        let (fx, fy) = cells[(i + 2) % cells.len()];
        check(maze(), p(fx, fy), p(x, y), Reached);
    }
}

#[test]
fn goals_behind_closed_walls_are_reported() {
    // Inside a block.
    let block = Convex::rectangle(p(1.0, 0.5), [1.0, 0.7], 0.4);
    check(vec![block], p(-4.0, 0.0), p(1.0, 0.5), Unreachable);
    // Inside a pole no larger than the robot.
    check(
        vec![Convex::disc(p(1.0, 0.5), 0.08)],
        p(-4.0, 0.0),
        p(1.0, 0.5),
        Unreachable,
    );
    // Into a closed pocket, and out of one.
    let pocket = [
        (-1.5, -1.0),
        (-1.5, 1.5),
        (1.0, 1.5),
        (1.5, -1.0),
        (-1.5, -1.0),
    ];
    for angle in [0.0, 0.5, 1.3, PI] {
        check(
            walls(&pocket, angle),
            turned(p(-4.0, 1.0), angle),
            p(0.0, 0.0),
            Unreachable,
        );
        check(
            walls(&pocket, angle),
            p(0.3, 0.0),
            turned(p(-4.0, 1.0), angle),
            Unreachable,
        );
    }
    // Beyond the bounds.
    check(vec![], p(0.0, 0.0), p(9.0, 1.0), Unreachable);
}

#[test]
fn a_walled_in_robot_reports_it() {
    let cell = [
        (-0.3, -0.3),
        (-0.3, 0.3),
        (0.3, 0.3),
        (0.3, -0.3),
        (-0.3, -0.3),
    ];
    let distance = check(walls(&cell, 0.2), p(0.0, 0.0), p(4.0, 1.0), Unreachable);
    assert!(distance < 5.0, "{distance}");
}

#[test]
fn an_island_inside_an_enclosure_is_left_before_the_enclosure_is_given_up() {
    let mut parts = walls(
        &[
            (-3.0, -3.0),
            (-3.0, 3.0),
            (3.0, 3.0),
            (3.0, -3.0),
            (-3.0, -3.0),
        ],
        0.1,
    );
    parts.push(Convex::rectangle(p(1.0, 0.0), [0.2, 1.0], 0.1));
    check(parts.clone(), p(-1.0, 0.0), p(5.0, 0.2), Unreachable);
    check(parts, p(-1.0, 0.0), p(2.0, 0.1), Reached);
}

#[test]
fn other_robots_and_sensors_come_through_as_well() {
    let trap = || walls(&[(-1.5, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.5, -1.0)], 0.3);
    let burger = Machine {
        radius: 0.105,
        v_max: 0.22,
        omega_max: 2.84,
        ..PATROL
    };
    let machines = [
        burger,
        Machine {
            range: 3.5,
            beams: 360,
            ..burger
        },
        Machine {
            radius: 0.2,
            ..PATROL
        },
        Machine {
            beams: 72,
            ..PATROL
        },
        Machine {
            noise: 0.01,
            ..PATROL
        },
        Machine {
            v_max: 0.5,
            accelerations: Some((1.0, 8.0)),
            ..PATROL
        },
    ];
    for machine in machines {
        let from = turned(p(0.0, 0.1), 0.3);
        let run = outcome_of(machine, trap(), from, turned(p(4.0, 0.0), 0.3));
        assert_eq!(run.reports[0].outcome, Reached, "{machine:?}");
    }
}

#[test]
fn invalid_input_is_refused_and_a_new_goal_starts_a_new_search() {
    let scan = ScanView {
        angle_min: 0.0,
        angle_increment: FRAC_PI_2,
        range_min: 0.0,
        range_max: 0.5,
        ranges: &[0.3; 4],
    };
    let none = ScanView {
        ranges: &[],
        ..scan
    };
    let mut bug = TangentBug::new(0.15).unwrap();
    let (pose, goal) = (Pose2::default(), p(3.0, 0.0));
    let lost = Pose2 {
        y: f64::INFINITY,
        ..pose
    };
    assert_eq!(bug.advise(&lost, &scan, goal, 0.05), None);
    assert_eq!(bug.advise(&pose, &none, goal, 0.05), None);
    assert_eq!(bug.advise(&pose, &scan, p(f64::NAN, 0.0), 0.05), None);
    assert_eq!(bug.advise(&pose, &scan, goal, f64::NAN), None);
    // Few beams give little information, but every echo counts; NaN is no echo.
    let blind = ScanView {
        ranges: &[f32::NAN; 4],
        ..scan
    };
    let straight = Advice::Head {
        towards: goal,
        mode: Mode::ToGoal,
    };
    assert_eq!(bug.advise(&pose, &blind, goal, 0.05), Some(straight));
    assert_ne!(bug.advise(&pose, &scan, goal, 0.05), Some(straight));

    // Walled in all around, until the goal changes.
    let near = [0.25; 90];
    let cell = ScanView {
        angle_increment: TAU / 90.0,
        ranges: &near,
        ..scan
    };
    let mut looks = 0;
    while bug.advise(&pose, &cell, goal, 0.05) != Some(Advice::Unreachable) {
        looks += 1;
        assert!(looks < 100);
    }
    assert_eq!(
        bug.advise(&pose, &blind, goal, 0.05),
        Some(Advice::Unreachable)
    );
    let other = p(3.0, 1.0);
    assert_ne!(
        bug.advise(&pose, &blind, other, 0.05),
        Some(Advice::Unreachable)
    );

    assert_eq!(TangentBug::new(0.0).unwrap_err().field, "radius");
}
