//! Relative positions as entries.

use nalgebra::Point2;

/// Number of entries of a relative position.
pub(crate) const LENGTH: usize = 5;

/// Names of the entries of a relative position.
pub(crate) const NAMES: [&str; LENGTH] =
    ["ahead", "left", "bearing_cos", "bearing_sin", "proximity"];

/// A heading as a unit vector.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Heading {
    pub cos: f32,
    pub sin: f32,
}

impl Heading {
    /// Returns the heading with this angle (rad).
    pub fn new(theta: f64) -> Self {
        let (sin, cos) = geometry::math::sincosf(theta as f32);
        Self { cos, sin }
    }

    /// Returns the opposite heading.
    pub fn opposite(self) -> Self {
        Self {
            cos: -self.cos,
            sin: -self.sin,
        }
    }

    /// Returns cosine and sine of another heading relative to this one.
    pub fn relative(self, other: Self) -> [f32; 2] {
        [
            self.cos * other.cos + self.sin * other.sin,
            self.cos * other.sin - self.sin * other.cos,
        ]
    }
}

/// Offset between two points, world frame.
///
/// Its fields are in the order in which one operation on four numbers turns them into a robot's frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Offset {
    /// Offset along x and y, divided by the diagonal of the map; unit vector along x and y, zero if the points
    /// coincide.
    along: [f32; 4],
    /// `along`, turned by −90°.
    across: [f32; 4],
    /// 1 / (1 + distance in m).
    proximity: f32,
}

impl Offset {
    /// Returns the offset between two points (m); `per_diagonal` is 1 / the diagonal of the map (1/m).
    pub fn new(from: Point2<f64>, to: Point2<f64>, per_diagonal: f32) -> Self {
        let (dx, dy) = ((to.x - from.x) as f32, (to.y - from.y) as f32);
        let distance = (dx * dx + dy * dy).sqrt();
        let inverse = if distance > 0.0 { 1.0 / distance } else { 0.0 };
        let (x, y) = (dx * per_diagonal, dy * per_diagonal);
        let (unit_x, unit_y) = (dx * inverse, dy * inverse);
        Self {
            along: [x, y, unit_x, unit_y],
            across: [y, -x, unit_y, -unit_x],
            proximity: 1.0 / (1.0 + distance),
        }
    }

    /// Returns the entries in the frame of a robot with this heading.
    pub fn entries(self, own: Heading) -> [f32; LENGTH] {
        let turned = core::array::from_fn(|i| own.cos * self.along[i] + own.sin * self.across[i]);
        let [ahead, left, bearing_cos, bearing_sin] = bounded(turned);
        [ahead, left, bearing_cos, bearing_sin, self.proximity]
    }
}

/// Returns numbers clamped to −1..1; 0 for NaN, which huge coordinates of a message may lead to. On several numbers at
/// once it needs no branch.
pub(crate) fn bounded<const N: usize>(values: [f32; N]) -> [f32; N] {
    values.map(|value| {
        let number = if value.is_nan() { 0.0 } else { value };
        number.clamp(-1.0, 1.0)
    })
}

#[cfg(test)]
mod tests {
    use core::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn a_body_to_the_left_is_left_whatever_the_heading() {
        // The robot looks along +y; the body is 2 m along −x.
        let offset = Offset::new(Point2::new(1.0, 1.0), Point2::new(-1.0, 1.0), 0.1);
        let [ahead, left, cos, sin, proximity] = offset.entries(Heading::new(FRAC_PI_2));
        assert!(ahead.abs() < 1e-6 && (left - 0.2).abs() < 1e-6);
        assert!(cos.abs() < 1e-6 && (sin - 1.0).abs() < 1e-6);
        assert!((proximity - 1.0 / 3.0).abs() < 1e-6);
    }

    #[test]
    fn coinciding_points_have_no_bearing() {
        let offset = Offset::new(Point2::origin(), Point2::origin(), 1.0);
        assert_eq!(offset.entries(Heading::new(0.3)), [0.0, 0.0, 0.0, 0.0, 1.0]);
    }
}
