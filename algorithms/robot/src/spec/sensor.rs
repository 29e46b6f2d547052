//! Sensors of a robot.

use core::f64::consts::TAU;

use parameters::{Parameters, ParamsError, between, require};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use geometry::extent::{not_negative, positive};

/// Maximum number of beams of a scan.
pub const MAX_BEAMS: usize = 4096;

/// A planar range scanner at the robot's centre.
///
/// Beam `i` points at `angle_min + i·angle_increment` from the robot's heading. A beam reports the
/// distance (m) to the first obstacle or robot; `+∞` if there is none within `range_max`, and `−∞`
/// if it is nearer than `range_min` (REP-117).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ScanSpec {
    /// Number of beams.
    #[schemars(transform = between(1, MAX_BEAMS))]
    pub beams: usize,
    /// Direction of the first beam from the robot's heading, counter-clockwise.
    #[schemars(transform = between(-TAU, TAU).unit("rad"))]
    pub angle_min: f64,
    /// Angle from one beam to the next, other than 0 if there are several beams.
    #[schemars(transform = between(-TAU, TAU).unit("rad"))]
    pub angle_increment: f64,
    /// Minimum range.
    #[schemars(transform = not_negative("m"))]
    pub range_min: f64,
    /// Maximum range, more than `range_min`.
    #[schemars(transform = positive("m"))]
    pub range_max: f64,
    /// Standard deviation of a measured distance; 0 is exact.
    #[schemars(transform = not_negative("m"))]
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

impl Parameters for ScanSpec {
    fn check_relations(&self) -> Result<(), ParamsError> {
        require(
            self.beams == 1 || self.angle_increment.abs() > 1e-9,
            "angle_increment",
            &self.angle_increment,
            "an angle other than 0 (rad)",
        )?;
        require(
            self.range_max > self.range_min,
            "range_max",
            &self.range_max,
            format!("more than range_min = {} (m)", self.range_min),
        )
    }
}

/// Noise of odometry: the standard deviation of each increment grows with the square root of the
/// distance and the rotation, as independent wheel errors do.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct OdometrySpec {
    /// Standard deviation of the distance per √distance.
    #[schemars(transform = not_negative("m/√m"))]
    pub distance_per_distance: f64,
    /// Standard deviation of the heading per √distance.
    #[schemars(transform = not_negative("rad/√m"))]
    pub heading_per_distance: f64,
    /// Standard deviation of the heading per √rotation.
    #[schemars(transform = not_negative("rad/√rad"))]
    pub heading_per_rotation: f64,
}

#[cfg(test)]
mod tests {
    use parameters::check;

    use super::*;

    #[test]
    fn the_default_scanner_is_valid_and_bad_ones_are_named() {
        assert!(check(&ScanSpec::default()).is_ok());
        let bad = |f: fn(&mut ScanSpec)| {
            let mut spec = ScanSpec::default();
            f(&mut spec);
            check(&spec).unwrap_err().field
        };
        let wide = ScanSpec {
            angle_min: -7.0,
            ..ScanSpec::default()
        };
        assert_eq!(
            check(&wide).unwrap_err().to_string(),
            "`angle_min` is -7: expected a number within ±2π (rad)"
        );
        assert_eq!(bad(|s| s.beams = 0), "beams");
        assert_eq!(bad(|s| s.beams = 1_000_000_000), "beams");
        assert_eq!(bad(|s| s.angle_increment = 0.0), "angle_increment");
        assert_eq!(bad(|s| s.range_max = 0.1), "range_max");
        assert_eq!(bad(|s| s.range_max = f64::NAN), "range_max");
        assert_eq!(bad(|s| s.noise = -1.0), "noise");
    }
}
