use parry2d_f64::query::{PointQuery, Ray};
use parry2d_f64::shape::Segment;
use proptest::prelude::*;

use super::*;

pub(in crate::shape) fn any_convex() -> impl Strategy<Value = Convex> {
    let center = || (-3.0..3.0f64, -3.0..3.0f64).prop_map(|(x, y)| Point2::new(x, y));
    let disc = (center(), 0.05..2.0f64).prop_map(|(c, r)| Convex::disc(c, r));
    let rectangle = (
        center(),
        0.05..2.0f64,
        0.05..2.0f64,
        prop_oneof![Just(0.0), -3.0..3.0f64],
    )
        .prop_map(|(c, a, b, angle)| Convex::rectangle(c, [a, b], angle));
    let polygon = (center(), 0.2..2.0f64, 3..9usize, 0.0..6.0f64).prop_map(|(c, r, n, turn)| {
        let corners: Vec<_> = (0..n)
            .map(|i| {
                let (sin, cos) = math::sincos(turn + core::f64::consts::TAU * i as f64 / n as f64);
                c + Vector2::new(cos, sin) * r
            })
            .collect();
        Convex::polygon(&corners)
    });
    prop_oneof![disc, rectangle, polygon]
}

fn any_point() -> impl Strategy<Value = Point2<f64>> {
    (-6.0..6.0f64, -6.0..6.0f64).prop_map(|(x, y)| Point2::new(x, y))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn distances_agree_with_parry(piece in any_convex(), p in any_point()) {
        let (pose, shape) = piece.to_parry();
        let theirs = shape.distance_to_point(&pose, Vector::new(p.x, p.y), true);
        prop_assert!((piece.distance(p) - theirs).abs() < 1e-9, "{} {theirs}", piece.distance(p));
        let contact = piece.contact(p);
        prop_assert!((contact.normal.norm() - 1.0).abs() < 1e-12);
        if theirs > 0.0 {
            prop_assert!((contact.distance - theirs).abs() < 1e-9);
        } else {
            let p = Vector::new(p.x, p.y);
            // parry's own depth inside a polygon is sometimes far off; the edges give the true
            // value.
            let depth = if let Some(polygon) = shape.as_convex_polygon() {
                let corners = polygon.points();
                let next = corners.iter().cycle().skip(1);
                let edges = corners.iter().zip(next).map(|(&a, &b)| Segment::new(a, b));
                edges.map(|edge| edge.distance_to_point(&pose, p, true)).fold(f64::INFINITY, f64::min)
            } else {
                (shape.project_point(&pose, p, false).point - p).length()
            };
            prop_assert!((contact.distance + depth).abs() < 1e-9, "{} {depth}", contact.distance);
        }
    }

    #[test]
    fn the_piece_lies_behind_its_contact_normal(
        piece in any_convex(), p in any_point(), q in any_point(),
    ) {
        let contact = piece.contact(p);
        let surface = p - contact.normal * contact.distance;
        if piece.distance(q) == 0.0 {
            prop_assert!((q - surface).dot(&contact.normal) < 1e-9);
        }
    }

    #[test]
    fn rays_agree_with_parry(piece in any_convex(), p in any_point(), angle in -3.2..3.2f64) {
        let (sin, cos) = math::sincos(angle);
        let (pose, shape) = piece.to_parry();
        let theirs = shape.cast_ray(&pose, &Ray::new(Vector::new(p.x, p.y), Vector::new(cos, sin)), 100.0, true);
        match (piece.ray(p, Vector2::new(cos, sin)), theirs) {
            (Some(a), Some(b)) => prop_assert!((a - b).abs() < 1e-6, "{a} {b}"),
            (None, None) => {}
            (ours, theirs) => {
                // The results may differ only at a graze.
                let t = ours.or(theirs).unwrap();
                let touch = p + Vector2::new(cos, sin) * t;
                let around = [-1e-4, 1e-4].map(|s| {
                    piece.ray(p + Vector2::new(-sin, cos) * s, Vector2::new(cos, sin)).is_some()
                });
                prop_assert!(around[0] != around[1], "{ours:?} {theirs:?} at {touch}");
            }
        }
    }
}
