//! Times and poses of a run as those of ROS 2.

use geometry::math::sincos;

use crate::messages::{Point, Pose, Quaternion, Time};

/// Converts simulated time (ns) to that of ROS.
pub fn time(time_ns: u64) -> Time {
    Time {
        // A run of more than 68 years ends at the largest time.
        sec: i32::try_from(time_ns / 1_000_000_000).unwrap_or(i32::MAX),
        nanosec: (time_ns % 1_000_000_000) as u32,
    }
}

/// Returns a rotation about the vertical axis (rad).
pub fn yaw(theta: f64) -> Quaternion {
    let (sin, cos) = sincos(theta / 2.0);
    Quaternion {
        x: 0.0,
        y: 0.0,
        z: sin,
        w: cos,
    }
}

/// Returns a pose: position (m), heading (rad).
pub fn pose(x: f64, y: f64, z: f64, theta: f64) -> Pose {
    Pose {
        position: Point { x, y, z },
        orientation: yaw(theta),
    }
}
