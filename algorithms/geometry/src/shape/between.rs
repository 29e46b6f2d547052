//! Test whether a piece lies between two points, without the place where.

use nalgebra::Point2;

use super::Convex;

/// Depth (m) below a surface from which a segment counts as inside: far above the rounding of rays at map coordinates.
const INSIDE: f64 = 1e-6;

impl Convex {
    /// Returns `true` if the segment between two points (m) passes more than a micrometre below the surface of the
    /// piece, so that [`Self::ray`] hits it before the end. `false` is no answer: near the surface, and always for
    /// discs and polygons.
    ///
    /// By the separating axes of a rectangle and a segment (Gottschalk, Lin and Manocha 1996), without a division.
    pub fn is_surely_between(&self, from: Point2<f64>, to: Point2<f64>) -> bool {
        let Self::Box(aabb) = self else {
            return false;
        };
        let size = aabb.half_extents();
        let (width, height) = (size.x - INSIDE, size.y - INSIDE);
        let half = (to - from) * 0.5;
        let offset = from + half - aabb.center();
        let (x, y) = (half.x.abs(), half.y.abs());
        width > 0.0
            && height > 0.0
            && offset.x.abs() < width + x
            && offset.y.abs() < height + y
            && (half.x * offset.y - half.y * offset.x).abs() < width * y + height * x
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;
    use proptest::prelude::*;

    use super::*;
    use crate::shape::Aabb;

    fn table() -> Convex {
        Convex::Box(Aabb {
            min: Point2::new(1.0, -1.0),
            max: Point2::new(3.0, 1.0),
        })
    }

    #[test]
    fn a_graze_is_left_to_the_ray() {
        let between = |a: [f64; 2], b: [f64; 2]| table().is_surely_between(a.into(), b.into());
        assert!(between([0.0, 0.0], [4.0, 0.0]));
        assert!(between([0.0, 0.0], [2.0, 0.0]), "the end lies inside");
        assert!(!between([0.0, 0.0], [1.0 + 1e-9, 0.0]));
        assert!(
            !between([0.0, 1.0 - 1e-9], [4.0, 1.0 - 1e-9]),
            "along a side"
        );
        assert!(!between([0.0, 0.0], [0.9, 0.0]), "the end lies before it");
        assert!(!between([0.0, 0.0], [4.0, f64::NAN]));
        assert!(!between([2.0, 0.0], [f64::INFINITY, 0.0]));
    }

    proptest! {
        #[test]
        fn what_is_between_is_hit_by_the_ray(
            from in prop::array::uniform2(-2.0..6.0f64), to in prop::array::uniform2(-2.0..6.0f64),
        ) {
            let (from, to) = (Point2::from(from), Point2::from(to));
            let length = (to - from).norm();
            let dir = if length > 0.0 { (to - from) / length } else { Vector2::x() };
            let hit = table().ray(from, dir).is_some_and(|t| t <= length - 1e-10);
            let between = table().is_surely_between(from, to);
            prop_assert!(hit || !between);
            // Nearly always the other way round, too.
            let deep = table().ray(from, dir).is_some_and(|t| {
                (0..=100).any(|k| {
                    let at = from + dir * (t + (length - t) * f64::from(k) / 100.0);
                    (at.x - 2.0).abs() < 0.99 && (at.y).abs() < 0.99 && t < length
                })
            });
            prop_assert!(between || !deep);
        }
    }
}
