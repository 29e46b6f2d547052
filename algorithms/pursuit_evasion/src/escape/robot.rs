//! A robot whose drive is computed in advance.

use geometry::pose::{Pose2, Twist2};
use parameters::positive;
use planner_view::limits::Limits;
use robot::drive::{integrate, limit};
use robot::spec::RobotModel;

/// A robot at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Robot {
    /// Pose, world frame.
    pub pose: Pose2,
    /// Twist, own frame.
    pub twist: Twist2,
    /// Body and limits.
    pub model: RobotModel,
    /// Length of a tick (s), > 0.
    pub dt: f64,
}

impl Robot {
    /// The robot a tick later, after a command, if nothing is in its way.
    #[must_use]
    pub fn after(&self, command: Twist2) -> Self {
        let twist = limit(&self.model, self.twist, command, self.dt);
        Self {
            pose: integrate(self.pose, twist, self.dt),
            twist,
            ..*self
        }
    }

    /// Limits of its drive for a planner; `None` if one of the model's is out of range.
    pub fn limits(&self) -> Option<Limits> {
        let RobotModel {
            v_max,
            v_reverse_max,
            omega_max,
            acceleration,
            angular_acceleration,
            wheel_speed_max,
            ..
        } = self.model;
        for limit in [acceleration, angular_acceleration, wheel_speed_max] {
            positive("limit", limit.unwrap_or(1.0)).ok()?;
        }
        Limits::new(v_max, v_reverse_max, omega_max).ok()
    }
}
