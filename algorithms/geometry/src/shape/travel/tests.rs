use parry2d_f64::math::{Pose, Vector as ParryVector};
use parry2d_f64::query;
use parry2d_f64::shape::Segment;
use proptest::prelude::*;

use super::super::convex::tests::any_convex;
use super::*;
use crate::math;

fn any_point() -> impl Strategy<Value = Point2<f64>> {
    (-6.0..6.0f64, -6.0..6.0f64).prop_map(|(x, y)| Point2::new(x, y))
}

fn any_arc() -> impl Strategy<Value = ShortArc> {
    (any_point(), 0.0..5.0f64, -3.2..3.2f64, 0.001..3.1f64).prop_map(
        |(center, radius, start, sweep)| {
            let unit = |angle: f64| {
                let (sin, cos) = math::sincos(angle);
                Vector2::new(cos, sin)
            };
            let (start, end) = (unit(start), unit(start + sweep));
            ShortArc {
                center,
                radius,
                start,
                end,
            }
        },
    )
}

/// Points along an arc, ends included, and the largest distance between neighbours.
fn along(arc: &ShortArc, count: usize) -> (Vec<Point2<f64>>, f64) {
    let sweep = math::atan2(arc.start.perp(&arc.end), arc.start.dot(&arc.end));
    let points = (0..=count).map(|i| {
        let (sin, cos) = math::sincos(sweep * i as f64 / count as f64);
        let direction = Vector2::new(
            cos * arc.start.x - sin * arc.start.y,
            sin * arc.start.x + cos * arc.start.y,
        );
        arc.at(direction)
    });
    (points.collect(), arc.radius * sweep / count as f64)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn segment_distances_agree_with_parry(
        piece in any_convex(), a in any_point(), b in any_point(), radius in 0.0..2.0f64,
    ) {
        let (pose, shape) = piece.to_parry();
        let segment = Segment::new(ParryVector::new(a.x, a.y), ParryVector::new(b.x, b.y));
        let theirs = query::distance(&Pose::IDENTITY, &segment, &pose, shape.as_ref()).unwrap();
        let ours = piece.segment_distance(a, b);
        prop_assert!((ours - theirs.distance).abs() < 1e-6, "{ours} {}", theirs.distance);
        // The predicate agrees with the distance everywhere but at the border.
        for r in [radius, ours + 1e-9, (ours - 1e-9).max(0.0)] {
            if ours > 0.0 && (r - ours).abs() > 1e-11 {
                prop_assert_eq!(piece.segment_is_clear(a, b, r), ours >= r, "{} {}", ours, r);
            }
        }
        if ours == 0.0 {
            prop_assert!(!piece.segment_is_clear(a, b, 1e-9));
        }
    }

    #[test]
    fn arcs_agree_with_points_along_them(
        piece in any_convex(), arc in any_arc(), radius in 0.001..2.0f64,
    ) {
        let (points, spacing) = along(&arc, 500);
        let nearest = points.iter().map(|&p| piece.distance(p)).fold(f64::INFINITY, f64::min);
        if nearest < radius - 1e-9 {
            prop_assert!(!piece.arc_is_clear(&arc, radius), "{nearest} {radius}");
        } else if nearest > radius + 0.5 * spacing {
            prop_assert!(piece.arc_is_clear(&arc, radius), "{nearest} {radius}");
        }
    }
}

#[test]
fn paths_along_the_border_touch_and_paths_through_it_do_not() {
    let square = Convex::rectangle(Point2::origin(), [1.0, 1.0], 0.0);
    let p = Point2::new;
    assert!(square.segment_is_clear(p(-2.0, 1.5), p(2.0, 1.5), 0.5));
    assert!(!square.segment_is_clear(p(-2.0, 1.5), p(2.0, 1.5), 0.5 + 1e-12));
    assert!(square.segment_is_clear(p(-1.0, 1.0), p(1.0, 1.0), 0.0));
    assert!(!square.segment_is_clear(p(-2.0, 0.0), p(2.0, 0.0), 0.0));
    assert!(!square.segment_is_clear(p(0.0, 0.0), p(0.0, 0.0), 0.0));
    // Half a circle around the upper side, from free space to free space.
    let arc = ShortArc {
        center: p(0.0, 1.0),
        radius: 0.25,
        start: Vector2::x(),
        end: -Vector2::x(),
    };
    assert!(
        !square.arc_is_clear(&arc, 1e-9),
        "its ends stand on the side"
    );
    let above = ShortArc {
        center: p(0.0, 1.1),
        ..arc
    };
    assert!(square.arc_is_clear(&above, 0.1 - 1e-12));
    // Through a thin wall, where neither end, corner nor parallel point is near.
    let wall = Convex::rectangle(Point2::origin(), [5.0, 0.01], 0.0);
    let across = ShortArc {
        center: p(2.0, 0.0),
        radius: 2.0,
        start: Vector2::new(-0.96, 0.28),
        end: Vector2::new(-0.96, -0.28),
    };
    assert!(!wall.arc_is_clear(&across, 0.05));
}
