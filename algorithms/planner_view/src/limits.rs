//! Limits of a robot's drive for planners.

use geometry::pose::Twist2;

use parameters::{ParamsError, not_negative, positive};

/// Speed limits of a differential-drive robot.
///
/// A planner never commands more than this; the simulator enforces its own limits as well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    v_max: f64,
    reverse: f64,
    omega_max: f64,
}

impl Limits {
    /// Creates limits from the maximum forward speed (m/s) (> 0), the maximum backward speed (m/s)
    /// (≥ 0, as a magnitude) and the maximum turning rate (rad/s) (> 0).
    ///
    /// # Errors
    /// [`ParamsError`] naming the value that is out of range or not finite.
    pub fn new(v_max: f64, reverse: f64, omega_max: f64) -> Result<Self, ParamsError> {
        positive("v_max", v_max)?;
        not_negative("reverse", reverse)?;
        positive("omega_max", omega_max)?;
        Ok(Self {
            v_max,
            reverse,
            omega_max,
        })
    }

    /// Maximum forward speed (m/s).
    pub fn v_max(&self) -> f64 {
        self.v_max
    }

    /// Maximum backward speed (m/s), as a magnitude.
    pub fn reverse(&self) -> f64 {
        self.reverse
    }

    /// Maximum turning rate (rad/s), either way.
    pub fn omega_max(&self) -> f64 {
        self.omega_max
    }

    /// These limits, with the backward speed no more than `fraction` of the forward one and the
    /// turning rate no more than `omega_cap` (rad/s). Neither can raise a limit.
    #[must_use]
    pub fn restricted(&self, reverse_fraction: f64, omega_cap: Option<f64>) -> Self {
        Self {
            v_max: self.v_max,
            // `min` and `max` return the other operand for NaN, so the result stays in range.
            reverse: self.reverse.min((reverse_fraction * self.v_max).max(0.0)),
            omega_max: omega_cap.map_or(self.omega_max, |cap| self.omega_max.min(cap.max(0.0))),
        }
    }

    /// The twist with each component clipped to the limits; a twist that is not finite becomes a
    /// stop.
    #[must_use]
    pub fn clip(&self, twist: Twist2) -> Twist2 {
        if !twist.is_finite() {
            return Twist2::STOP;
        }
        Twist2::new(
            twist.v.clamp(-self.reverse, self.v_max),
            twist.omega.clamp(-self.omega_max, self.omega_max),
        )
    }

    /// Returns `true` if a twist is finite and within the limits.
    pub fn allow(&self, twist: Twist2) -> bool {
        twist.is_finite()
            && twist.v >= -self.reverse
            && twist.v <= self.v_max
            && twist.omega.abs() <= self.omega_max
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_that_no_robot_can_have_are_refused() {
        assert_eq!(Limits::new(f64::NAN, 0.0, 1.0).unwrap_err().field, "v_max");
        assert_eq!(Limits::new(1.0, -0.1, 1.0).unwrap_err().field, "reverse");
        assert_eq!(Limits::new(1.0, 0.0, 0.0).unwrap_err().field, "omega_max");
    }

    #[test]
    fn restrictions_only_ever_lower_a_limit() {
        let limits = Limits::new(0.3, 0.1, 2.0).unwrap();
        let paper = limits.restricted(0.1, Some(0.5));
        assert!((paper.reverse() - 0.03).abs() < 1e-15);
        assert_eq!(paper.omega_max(), 0.5);
        let same = limits.restricted(1.0, Some(9.0));
        assert_eq!(same, limits);
    }

    #[test]
    fn clipping_stops_on_nan_and_bounds_the_rest() {
        let limits = Limits::new(0.3, 0.1, 2.0).unwrap();
        assert_eq!(limits.clip(Twist2::new(f64::NAN, 1.0)), Twist2::STOP);
        assert_eq!(limits.clip(Twist2::new(-9.0, 9.0)), Twist2::new(-0.1, 2.0));
        assert!(limits.allow(limits.clip(Twist2::new(1e300, -1e300))));
    }
}
