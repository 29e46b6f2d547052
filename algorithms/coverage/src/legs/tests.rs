use planner_view::waypoint::{Waypoint, WaypointKind};
use proptest::prelude::*;

use super::*;

fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Aabb {
    Aabb {
        min: Point2::new(x0, y0),
        max: Point2::new(x1, y1),
    }
}

fn goal(x: f64, y: f64, within: Option<Aabb>) -> Goal {
    Goal {
        waypoint: Waypoint {
            number: 0,
            lap: 0,
            kind: WaypointKind::SubGoal,
            point: Point2::new(x, y),
        },
        within,
    }
}

fn path(rounding: Rounding, start: Point2<f64>, goals: &[Goal]) -> Vec<Piece> {
    let mut rounder = Rounder::new(rounding, start, None);
    let mut pieces = Vec::new();
    for goal in goals {
        rounder.push(goal, &mut pieces);
    }
    rounder.finish(&mut pieces);
    pieces
}

/// Maximum jump of position (m) and heading (rad) between the end of a piece and the next one.
fn worst_joint(pieces: &[Piece]) -> (f64, f64) {
    pieces.windows(2).fold((0.0, 0.0), |(place, turn), pair| {
        let (end, start) = (pair[0].at(1.0), pair[1].at(0.0));
        let jump = (start.position() - end.position()).norm();
        let swing = math::angle_difference(start.theta, end.theta).abs();
        (jump.max(place), swing.max(turn))
    })
}

#[test]
fn a_right_angle_with_room_gets_the_robots_own_circle() {
    let all = rectangle(0.0, 0.0, 9.0, 9.0);
    let corner = [
        Point2::new(1.0, 1.0),
        Point2::new(5.0, 1.0),
        Point2::new(5.0, 6.0),
    ];
    let fillet = fillet(corner, &all, &all, 0.5, 1.0).unwrap();
    assert!((fillet.enter - Point2::new(4.5, 1.0)).norm() < 1e-12);
    assert!((fillet.leave - Point2::new(5.0, 1.5)).norm() < 1e-12);
    assert!((fillet.arc.center - Point2::new(4.5, 1.5)).norm() < 1e-12);
    assert!((fillet.arc.at(1.0) - fillet.leave).norm() < 1e-12);
}

#[test]
fn an_arc_takes_at_most_half_of_a_short_leg() {
    let all = rectangle(0.0, 0.0, 9.0, 9.0);
    let corner = [
        Point2::new(1.0, 1.0),
        Point2::new(5.0, 1.0),
        Point2::new(5.0, 1.4),
    ];
    let fillet = fillet(corner, &all, &all, 0.5, 1.0).unwrap();
    assert!((fillet.arc.radius - 0.2).abs() < 1e-12);
}

#[test]
fn a_corner_between_rectangles_is_rounded_only_where_one_of_them_holds_the_triangle() {
    // From the left rectangle into the upper one: their overlap ends 0.1 m beyond the corner, and
    // the triangle must not leave both at once.
    let (left, up) = (rectangle(0.0, 0.0, 5.1, 2.0), rectangle(4.8, 0.0, 6.0, 9.0));
    let corner = [
        Point2::new(1.0, 1.9),
        Point2::new(5.0, 1.9),
        Point2::new(5.0, 6.0),
    ];
    let fillet = fillet(corner, &left, &up, 1.0, 1.0).unwrap();
    // Up to x = 4.8, where the second rectangle begins.
    assert!((fillet.arc.radius - 0.2).abs() < 1e-12);
    // No room: the corner lies in the corner of both.
    let (left, up) = (rectangle(0.0, 0.0, 5.0, 2.0), rectangle(5.0, 0.0, 6.0, 9.0));
    let corner = [
        Point2::new(1.0, 2.0),
        Point2::new(5.0, 2.0),
        Point2::new(5.0, 6.0),
    ];
    assert_eq!(super::fillet(corner, &left, &up, 1.0, 1.0), None);
}

#[test]
fn a_reversal_is_turned_on_the_spot() {
    let all = rectangle(0.0, 0.0, 9.0, 9.0);
    let rounding = Rounding::new(1.0, 2.0, 1.0, 0.01).unwrap();
    let goals = [goal(5.0, 1.0, Some(all)), goal(2.0, 1.0, Some(all))];
    let pieces = path(rounding, Point2::new(1.0, 1.0), &goals);
    let [
        Piece::Straight { .. },
        Piece::Turn { by, .. },
        Piece::Straight { .. },
    ] = pieces[..]
    else {
        panic!("{pieces:?}")
    };
    assert!((by.abs() - core::f64::consts::PI).abs() < 1e-12);
    // 7 m at 1 m/s and half a turn at 2 rad/s.
    let duration: f64 = pieces.iter().map(|p| p.duration(&rounding)).sum();
    assert!((duration - 7.0 - core::f64::consts::FRAC_PI_2).abs() < 1e-12);
}

#[test]
fn corners_of_unchecked_legs_stay() {
    let rounding = Rounding::new(1.0, 2.0, 1.0, 0.01).unwrap();
    let goals = [goal(5.0, 1.0, None), goal(5.0, 4.0, None)];
    let pieces = path(rounding, Point2::new(1.0, 1.0), &goals);
    assert!(!pieces.iter().any(|p| matches!(p, Piece::Arc(_))));
    assert_eq!(worst_joint(&pieces), (0.0, 0.0));
}

#[test]
fn a_robot_that_looks_elsewhere_turns_first() {
    let rounding = Rounding::new(1.0, 2.0, 1.0, 0.01).unwrap();
    let mut rounder = Rounder::new(rounding, Point2::new(1.0, 1.0), Some(1.0));
    let mut pieces = Vec::new();
    rounder.push(&goal(5.0, 1.0, None), &mut pieces);
    assert!(pieces.is_empty());
    rounder.finish(&mut pieces);
    let Piece::Turn { from, by, .. } = pieces[0] else {
        panic!("{pieces:?}")
    };
    assert!((from - 1.0).abs() < 1e-12 && (by + 1.0).abs() < 1e-12);
}

#[test]
fn limits_that_no_robot_has_are_refused() {
    let error = Rounding::new(0.0, 1.0, 1.0, 0.0).unwrap_err();
    assert_eq!(
        error.to_string(),
        "v = 0: expected a finite number > 0 (m/s)"
    );
    assert_eq!(
        Rounding::new(1.0, f64::NAN, 1.0, 0.0).unwrap_err().field,
        "omega"
    );
    assert_eq!(
        Rounding::new(1.0, 1.0, 0.0, 0.0).unwrap_err().field,
        "max_miss"
    );
    let error = Rounding::new(1.0, 1.0, 1.0, -1.0).unwrap_err();
    assert_eq!(error.field, "least_radius");
}

proptest! {
    #[test]
    fn an_arc_lies_in_the_triangle_and_in_one_of_the_rectangles(
        points in prop::array::uniform3((0.0..9.0, 0.0..9.0)),
        margins in prop::array::uniform4(0.0..1.0),
        radius in 0.001..5.0,
        max_miss in 0.01..2.0,
    ) {
        let [a, b, c] = points.map(|(x, y)| Point2::new(x, y));
        let around = |p: Point2<f64>, q: Point2<f64>, low: f64, high: f64| Aabb {
            min: p.inf(&q) - Vector2::repeat(low),
            max: p.sup(&q) + Vector2::repeat(high),
        };
        let first = around(a, b, margins[0], margins[1]);
        let second = around(b, c, margins[2], margins[3]);
        let Some(fillet) = fillet([a, b, c], &first, &second, radius, max_miss) else {
            return Ok(());
        };
        prop_assert!(fillet.arc.radius <= radius * (1.0 + 1e-9));
        let miss = (fillet.arc.at(0.5) - b).norm();
        prop_assert!(miss <= max_miss * (1.0 + 1e-6), "{miss} {max_miss}");
        let (u, w) = ((b - a).normalize(), (c - b).normalize());
        prop_assert!((fillet.enter - b).norm() <= 0.5 * (b - a).norm() + 1e-9);
        prop_assert!((fillet.leave - b).norm() <= 0.5 * (c - b).norm() + 1e-9);
        // Tangent to both legs at its ends.
        prop_assert!((fillet.arc.at(0.0) - fillet.enter).norm() < 1e-6);
        prop_assert!((fillet.arc.at(1.0) - fillet.leave).norm() < 1e-6);
        prop_assert!((fillet.arc.heading(0.0) - u).norm() < 1e-6);
        prop_assert!((fillet.arc.heading(1.0) - w).norm() < 1e-6);
        // On the inner side of all three sides of EBF.
        let side = u.perp(&w).signum();
        let chord = fillet.leave - fillet.enter;
        let (mut in_first, mut in_second) = (0.0_f64, 0.0_f64);
        for i in 0..=40 {
            let p = fillet.arc.at(f64::from(i) / 40.0);
            prop_assert!(side * u.perp(&(p - fillet.enter)) >= -1e-9);
            prop_assert!(side * w.perp(&(p - b)) >= -1e-9);
            prop_assert!(side * chord.perp(&(p - fillet.enter)) <= 1e-9);
            in_first = in_first.max(first.distance(p));
            in_second = in_second.max(second.distance(p));
        }
        prop_assert!(in_first.min(in_second) <= 1e-9, "{in_first} {in_second}");
    }

    #[test]
    fn a_rounded_path_has_no_jumps_and_keeps_to_the_limits(
        points in prop::collection::vec((0.1..8.9, 0.1..8.9), 3..20),
        v in 0.1..2.0,
        omega in 0.5..4.0,
    ) {
        let all = rectangle(0.0, 0.0, 9.0, 9.0);
        let rounding = Rounding::new(v, omega, 1.0, 0.01).unwrap();
        let start = Point2::new(points[0].0, points[0].1);
        let goals: Vec<Goal> = points[1..].iter().map(|&(x, y)| goal(x, y, Some(all))).collect();
        let pieces = path(rounding, start, &goals);
        let (place, turn) = worst_joint(&pieces);
        prop_assert!(place < 1e-6 && turn < 1e-5, "{place} {turn}");
        prop_assert!((pieces.last().unwrap().at(1.0).position() - goals.last().unwrap().waypoint.point).norm() < 1e-9);
        let straight: f64 = goals
            .iter()
            .fold((start, 0.0), |(from, sum), g| (g.waypoint.point, sum + (g.waypoint.point - from).norm()))
            .1;
        let length: f64 = pieces.iter().map(Piece::length).sum();
        prop_assert!(length <= straight + 1e-9);
        for piece in &pieces {
            if piece.length() > 0.0 {
                let speed = piece.length() / piece.duration(&rounding);
                prop_assert!(speed <= v * (1.0 + 1e-9));
                prop_assert!(speed * piece.curvature().abs() <= omega * (1.0 + 1e-9));
            }
            for pose in piece.poses(0.1) {
                prop_assert!(all.contains(pose.position()));
            }
        }
    }
}
