//! Straight lines that touch circles on the side on which a path bends around them.

use nalgebra::{Point2, Vector2};

/// Direction in which a path goes around a circle: 1 counter-clockwise, −1 clockwise.
pub type Turn = f64;

/// A tangent segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tangent {
    /// Length (m).
    pub length: f64,
    /// Unit vector from the first circle's centre to the start of the segment.
    pub from: Vector2<f64>,
    /// Unit vector from the second circle's centre to the end of the segment.
    pub to: Vector2<f64>,
}

/// The segment that leaves a circle (radius `r1` ≥ 0, travelled around by `s1`) and joins another,
/// whose centre is at `offset`; `None` if one circle contains the other (or they overlap and the
/// segment would have to change sides).
///
/// A path with heading `u` touches at `c − s r i u`, where `i` turns by a quarter counter-clockwise.
/// The segment from one such point to the other is `l u`, hence with complex numbers
/// `offset = (l + i k) u`, `k = s2 r2 − s1 r1`, which gives `l² = |offset|² − k²` and
/// `u = offset (l − i k) / |offset|²`.
#[inline]
pub fn between(
    offset: Vector2<f64>,
    (r1, s1): (f64, Turn),
    (r2, s2): (f64, Turn),
) -> Option<Tangent> {
    let squared = offset.norm_squared();
    let k = s2 * r2 - s1 * r1;
    let rest = squared - k * k;
    if squared <= 0.0 || rest < 0.0 {
        return None;
    }
    let length = rest.sqrt();
    let u = Vector2::new(
        length * offset.x + k * offset.y,
        length * offset.y - k * offset.x,
    ) / squared;
    let left = Vector2::new(-u.y, u.x);
    Some(Tangent {
        length,
        from: left * -s1,
        to: left * -s2,
    })
}

/// The two segments from a point to a circle: their length (m), and the unit vectors from the
/// centre to the touching points; first the one that joins counter-clockwise, then the one that
/// joins clockwise. A point on the circle, or inside it by no more than `slack` (m), is its own
/// touching point; `None` further inside.
///
/// As [`between`] with a first radius of 0: the touching point lies in the direction `−i s u`.
#[inline]
pub fn from_point(
    p: Point2<f64>,
    center: Point2<f64>,
    radius: f64,
    slack: f64,
) -> Option<(f64, [Vector2<f64>; 2])> {
    let offset = center - p;
    let squared = offset.norm_squared();
    let rest = squared - radius * radius;
    if rest <= 0.0 {
        let distance = squared.sqrt();
        let on = distance > 0.0 && distance >= radius - slack;
        return on.then(|| (0.0, [-offset / distance; 2]));
    }
    let length = rest.sqrt();
    let back = offset * (-radius / squared);
    let side = Vector2::new(-offset.y, offset.x) * (length / squared);
    Some((length, [back - side, back + side]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tangents_touch_both_circles_at_right_angles_and_keep_their_sides() {
        let (a, b) = (Point2::new(1.0, -2.0), Point2::new(4.0, 0.5));
        for (r1, r2) in [(0.5, 1.0), (1.0, 0.25), (0.7, 0.7)] {
            for (s1, s2) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                let tangent = between(b - a, (r1, s1), (r2, s2)).unwrap();
                let (p, q) = (a + tangent.from * r1, b + tangent.to * r2);
                let u = (q - p) / tangent.length;
                assert!((u.norm() - 1.0).abs() < 1e-12);
                // The circle a path goes around counter-clockwise lies to its left.
                assert!((u.perp(&(a - p)) - s1 * r1).abs() < 1e-12);
                assert!((u.perp(&(b - q)) - s2 * r2).abs() < 1e-12);
                assert!(u.dot(&tangent.from).abs() < 1e-12 && u.dot(&tangent.to).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn tangents_from_a_point_are_those_from_a_circle_without_radius() {
        let (p, center) = (Point2::new(-1.0, 0.5), Point2::new(2.0, 1.5));
        let (length, touches) = from_point(p, center, 0.7, 0.0).unwrap();
        for (touch, turn) in touches.into_iter().zip([1.0, -1.0]) {
            let tangent = between(center - p, (0.0, turn), (0.7, turn)).unwrap();
            assert!((length - tangent.length).abs() < 1e-12);
            assert!((touch - tangent.to).norm() < 1e-12);
        }
    }

    #[test]
    fn overlapping_circles_have_outer_tangents_only() {
        let offset = Vector2::new(1.0, 0.0);
        assert!(between(offset, (0.8, 1.0), (0.8, 1.0)).is_some());
        assert!(between(offset, (0.8, 1.0), (0.8, -1.0)).is_none());
        assert!(between(offset, (3.0, 1.0), (0.8, 1.0)).is_none());
        assert!(between(Vector2::zeros(), (1.0, 1.0), (1.0, 1.0)).is_none());
    }

    #[test]
    fn a_point_on_the_circle_is_its_own_touching_point() {
        let (p, center) = (Point2::new(2.0, 0.0), Point2::new(1.0, 0.0));
        for radius in [1.0, 1.0 + 1e-10] {
            let touching = from_point(p, center, radius, 1e-9).unwrap();
            assert_eq!(touching, (0.0, [Vector2::x(); 2]));
        }
        assert!(from_point(p, center, 1.1, 1e-9).is_none());
        assert!(from_point(center, center, 1.0, 1e-9).is_none());
    }
}
