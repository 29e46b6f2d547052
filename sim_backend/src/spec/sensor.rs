//! Sensors of a robot.

use core::f64::consts::TAU;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{non_negative, positive};
use crate::params::{ParamsError, require};

/// Most beams that one scan may have.
const MAX_BEAMS: usize = 65_536;

/// A planar range scanner at the robot's centre.
///
/// Beam `i` points at `angle_min + i·angle_increment` from the robot's heading. A beam reports the
/// distance (m) to the first obstacle or robot; `+∞` if there is none within `range_max`, and `−∞`
/// if it is nearer than `range_min` (REP-117).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ScanSpec {
    /// Number of beams, in [1, 65536].
    pub beams: usize,
    /// Direction of the first beam from the robot's heading (rad), counter-clockwise.
    pub angle_min: f64,
    /// Angle from one beam to the next (rad), ≠ 0 if there are several beams.
    pub angle_increment: f64,
    /// Nearest distance that can be measured (m), ≥ 0.
    pub range_min: f64,
    /// Farthest distance that can be measured (m), > `range_min`.
    pub range_max: f64,
    /// Standard deviation of a measured distance (m), ≥ 0; 0 is exact.
    pub noise: f64,
}

impl Default for ScanSpec {
    /// The `TurtleBot3`'s LDS-01: 360 beams all around, 0.12 m to 3.5 m, σ = 0.01 m.
    fn default() -> Self {
        Self {
            beams: 360,
            angle_min: 0.0,
            angle_increment: TAU / 360.0,
            range_min: 0.12,
            range_max: 3.5,
            noise: 0.01,
        }
    }
}

impl ScanSpec {
    /// Checks every field.
    ///
    /// # Errors
    /// Names the first field that is out of its range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        require(
            (1..=MAX_BEAMS).contains(&self.beams),
            "beams",
            &self.beams,
            format!("a number of beams in [1, {MAX_BEAMS}]"),
        )?;
        require(
            self.angle_min.abs() <= TAU,
            "angle_min",
            &self.angle_min,
            "an angle in ±2π [rad]",
        )?;
        require(
            self.angle_increment.abs() <= TAU
                && (self.beams == 1 || self.angle_increment.abs() > 1e-9),
            "angle_increment",
            &self.angle_increment,
            "an angle in ±2π other than 0 [rad]",
        )?;
        non_negative("range_min", self.range_min, "m")?;
        positive("range_max", self.range_max, "m")?;
        require(
            self.range_max > self.range_min,
            "range_max",
            &self.range_max,
            format!("more than range_min = {} [m]", self.range_min),
        )?;
        non_negative("noise", self.noise, "m")
    }
}

/// Noise of odometry: the standard deviation of each increment grows with the square root of the
/// way driven and turned, as independent wheel errors do.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct OdometrySpec {
    /// Standard deviation of the distance per √distance (m/√m), ≥ 0.
    pub distance_per_distance: f64,
    /// Standard deviation of the heading per √distance (rad/√m), ≥ 0.
    pub heading_per_distance: f64,
    /// Standard deviation of the heading per √rotation (rad/√rad), ≥ 0.
    pub heading_per_rotation: f64,
}

impl OdometrySpec {
    /// Checks every field.
    ///
    /// # Errors
    /// Names the first field that is out of its range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        non_negative("distance_per_distance", self.distance_per_distance, "m/√m")?;
        non_negative("heading_per_distance", self.heading_per_distance, "rad/√m")?;
        non_negative(
            "heading_per_rotation",
            self.heading_per_rotation,
            "rad/√rad",
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_scanner_is_valid_and_bad_ones_are_named() {
        assert!(ScanSpec::default().validate().is_ok());
        let bad = |f: fn(&mut ScanSpec)| {
            let mut spec = ScanSpec::default();
            f(&mut spec);
            spec.validate().unwrap_err().field
        };
        assert_eq!(bad(|s| s.beams = 0), "beams");
        assert_eq!(bad(|s| s.beams = 1_000_000_000), "beams");
        assert_eq!(bad(|s| s.angle_increment = 0.0), "angle_increment");
        assert_eq!(bad(|s| s.range_max = 0.1), "range_max");
        assert_eq!(bad(|s| s.range_max = f64::NAN), "range_max");
        assert_eq!(bad(|s| s.noise = -1.0), "noise");
    }
}
