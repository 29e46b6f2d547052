//! One sample of a trajectory.

use core::f64::consts::TAU;

use nalgebra::Point2;

/// Pose and controls of the robot at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time since the start (s); 0 at the first sample, never decreasing.
    pub t: f64,
    /// Position of the robot's centre, east (m).
    pub x: f64,
    /// Position of the robot's centre, north (m).
    pub y: f64,
    /// Heading (rad), counter-clockwise from east; any multiple of a full turn may be added.
    pub theta: f64,
    /// Forward speed (m/s); negative backwards.
    pub v: f64,
    /// Turning rate (rad/s), counter-clockwise.
    pub omega: f64,
}

impl Sample {
    /// Position of the robot's centre (m).
    pub(crate) fn position(&self) -> Point2<f64> {
        Point2::new(self.x, self.y)
    }

    /// Every number with its name.
    pub(crate) fn fields(&self) -> [(&'static str, f64); 6] {
        [
            ("t", self.t),
            ("x", self.x),
            ("y", self.y),
            ("theta", self.theta),
            ("v", self.v),
            ("omega", self.omega),
        ]
    }
}

/// An angle (rad) without its full turns, in [−π, π].
pub fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use super::*;

    #[test]
    fn full_turns_do_not_count() {
        assert!((wrapped(0.3 - 4.0 * TAU) - 0.3).abs() < 1e-12);
        assert!((wrapped(3.0 * PI).abs() - PI).abs() < 1e-12);
        assert!(wrapped(f64::NAN).is_nan());
    }
}
