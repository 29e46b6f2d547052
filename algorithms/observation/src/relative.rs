//! Relative positions as entries.

use nalgebra::Point2;

/// Number of entries of a relative position.
pub(crate) const LENGTH: usize = 5;

/// Names of the entries of a relative position.
pub(crate) const NAMES: [&str; LENGTH] =
    ["ahead", "left", "bearing_cos", "bearing_sin", "proximity"];

/// A heading as a unit vector.
#[derive(Debug, Clone, Copy, PartialEq)]
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

    /// Returns cosine and sine of another heading relative to this one.
    pub fn relative(self, other: Self) -> [f32; 2] {
        [
            self.cos * other.cos + self.sin * other.sin,
            self.cos * other.sin - self.sin * other.cos,
        ]
    }
}

/// Offset between two points, world frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Offset {
    /// Offset along x and y, divided by the diagonal of the map.
    scaled: [f32; 2],
    /// Unit vector; zero if the points coincide.
    direction: [f32; 2],
    /// 1 / (1 + distance in m).
    proximity: f32,
}

impl Offset {
    /// Returns the offset between two points (m); `per_diagonal` is 1 / the diagonal of the map (1/m).
    pub fn new(from: Point2<f64>, to: Point2<f64>, per_diagonal: f32) -> Self {
        let (dx, dy) = ((to.x - from.x) as f32, (to.y - from.y) as f32);
        let distance = (dx * dx + dy * dy).sqrt();
        let inverse = if distance > 0.0 { 1.0 / distance } else { 0.0 };
        Self {
            scaled: [dx * per_diagonal, dy * per_diagonal],
            direction: [dx * inverse, dy * inverse],
            proximity: 1.0 / (1.0 + distance),
        }
    }

    /// Returns the offset in the other direction.
    pub fn reversed(self) -> Self {
        Self {
            scaled: self.scaled.map(|x| -x),
            direction: self.direction.map(|x| -x),
            ..self
        }
    }

    /// Returns the entries in the frame of a robot with this heading.
    pub fn entries(self, own: Heading) -> [f32; LENGTH] {
        let ahead = |[x, y]: [f32; 2]| own.cos * x + own.sin * y;
        let left = |[x, y]: [f32; 2]| own.cos * y - own.sin * x;
        [
            bounded(ahead(self.scaled)),
            bounded(left(self.scaled)),
            bounded(ahead(self.direction)),
            bounded(left(self.direction)),
            self.proximity,
        ]
    }
}

/// Returns a number clamped to −1..1; 0 for NaN, which huge coordinates of a message may lead to.
pub(crate) fn bounded(value: f32) -> f32 {
    if value.is_nan() {
        0.0
    } else {
        value.clamp(-1.0, 1.0)
    }
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
