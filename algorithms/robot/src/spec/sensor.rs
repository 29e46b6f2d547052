//! Sensors of a robot.

use core::f64::consts::TAU;

use parameters::{Parameters, ParamsError, between, require};

use geometry::extent::{not_negative, positive};

/// Maximum number of beams of a scan.
pub const MAX_BEAMS: usize = 4096;

parameters::table! {
    /// A planar range scanner at the robot's centre.
    ///
    /// Beam `i` points at `angle_min + i·angle_increment` from the robot's heading. A beam reports the
    /// distance (m) to the first obstacle or robot; `+∞` if there is none within `range_max`, and `−∞`
    /// if it is nearer than `range_min` (REP-117).
    #[derive(Copy)]
    pub struct ScanSpec {
        /// Number of beams.
        pub beams: usize [between(1, MAX_BEAMS)] = 360,
        /// Direction of the first beam from the robot's heading, counter-clockwise.
        pub angle_min: f64 [between(-TAU, TAU).unit("rad")] = 0.0,
        /// Angle from one beam to the next, other than 0 if there are several beams.
        pub angle_increment: f64 [between(-TAU, TAU).unit("rad")] = TAU / 360.0,
        /// Minimum range.
        pub range_min: f64 [not_negative("m")] = 0.12,
        /// Maximum range, more than `range_min`.
        pub range_max: f64 [positive("m")] = 3.5,
        /// Standard deviation of a measured distance; 0 is exact.
        pub noise: f64 [not_negative("m")] = 0.01,
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

parameters::table! {
    /// Noise of odometry: the standard deviation of each increment grows with the square root of the
    /// distance and the rotation, as independent wheel errors do.
    #[derive(Copy)]
    pub struct OdometrySpec {
        /// Standard deviation of the distance per √distance.
        pub distance_per_distance: f64 [not_negative("m/√m")],
        /// Standard deviation of the heading per √distance.
        pub heading_per_distance: f64 [not_negative("rad/√m")],
        /// Standard deviation of the heading per √rotation.
        pub heading_per_rotation: f64 [not_negative("rad/√rad")],
    }
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
