//! Times and poses of a run as those of ROS 2, and back.

use geometry::math::{atan2, sincos};
use geometry::pose::Pose2;

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

/// Returns the pose in the plane with this position (m) and the heading of a rotation about the vertical axis.
pub fn pose2(x: f64, y: f64, rotation: &Quaternion) -> Pose2 {
    Pose2::new(x, y, 2.0 * atan2(rotation.z, rotation.w))
}

/// Returns this pose if its numbers are finite, and the rotation leaves the vertical axis upright, up to 0.45 rad.
pub fn upright_pose(x: f64, y: f64, rotation: &Quaternion) -> Option<Pose2> {
    let tilt = rotation.x * rotation.x + rotation.y * rotation.y;
    let norm = tilt + rotation.z * rotation.z + rotation.w * rotation.w;
    let pose = pose2(x, y, rotation);
    (pose.is_finite() && norm > 0.0 && tilt <= 0.05 * norm).then_some(pose)
}
