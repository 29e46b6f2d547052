//! Distances that robots keep when they pass each other.

use nalgebra::Point2;

/// Distances that robots keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spacing {
    /// Distance of a robot's centre from obstacles (m).
    pub clearance: f64,
    /// Distance between the centres of two robots of which one passes the other (m).
    pub apart: f64,
    /// Distance of two places (m), a little longer.
    pub places: f64,
}

impl Spacing {
    /// Returns `true` if a robot that drives straight from `from` to `to` (m) passes the place `other` (m). If one of
    /// these is too near to it already, the robot comes no nearer on the way.
    pub(super) fn passes(&self, other: Point2<f64>, from: Point2<f64>, to: Point2<f64>) -> bool {
        let ends = (other - from).norm().min((other - to).norm());
        to_segment(other, from, to) >= self.apart.min(ends) - 1e-9
    }
}

/// Distance (m) of a point from the segment from `a` to `b`.
pub fn to_segment(p: Point2<f64>, a: Point2<f64>, b: Point2<f64>) -> f64 {
    let (way, off) = (b - a, p - a);
    let length = way.norm_squared();
    let part = if length > 0.0 {
        (off.dot(&way) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (off - way * part).norm()
}
