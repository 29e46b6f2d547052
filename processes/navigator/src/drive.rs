//! Limits of the robot's drive, applied to commands.

use geometry::pose::Twist2;
use robot::drive::limit;
use robot::spec::RobotModel;

/// The drive of a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    model: RobotModel,
}

impl Drive {
    /// Returns the drive of a robot of this model.
    pub fn new(model: RobotModel) -> Self {
        Self { model }
    }

    /// Body and limits.
    pub fn model(&self) -> &RobotModel {
        &self.model
    }

    /// Returns the highest speed (m/s) on a straight line, as a magnitude; of a robot that drives
    /// backwards if `backwards`.
    pub fn top_speed(&self, backwards: bool) -> f64 {
        let wheels = self.model.wheel_speed_max.unwrap_or(f64::INFINITY);
        let top = if backwards {
            self.model.v_reverse_max
        } else {
            self.model.v_max
        };
        top.min(wheels)
    }

    /// Returns the command within the limits of the speeds, without regard to those of their changes.
    /// Non-finite values become a stop.
    pub fn clip(&self, twist: Twist2) -> Twist2 {
        Self::new(self.model.without_inertia()).execute(Twist2::STOP, twist, 0.0)
    }

    /// Returns the speeds that the simulator executes for `command` during `dt` (s) after
    /// `current`. Non-finite values become a stop.
    pub fn execute(&self, current: Twist2, command: Twist2, dt: f64) -> Twist2 {
        let command = if command.is_finite() {
            command
        } else {
            Twist2::STOP
        };
        limit(&self.model, current, command, dt)
    }

    /// Returns the distance (m) that stopping takes from a speed (m/s).
    pub fn braking_distance(&self, speed: f64) -> f64 {
        self.model
            .acceleration
            .map_or(0.0, |a| speed * speed / (2.0 * a))
    }

    /// Returns the maximum distance (m) that a robot with this `speed` (m/s) can cover within `dt`
    /// (s) and while it stops afterwards.
    pub fn reach(&self, speed: f64, dt: f64) -> f64 {
        let top = self.model.v_max.max(self.model.v_reverse_max);
        let next = self
            .model
            .acceleration
            .map_or(top, |a| top.min(speed.abs() + a * dt));
        next * dt + self.braking_distance(next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wheels_share_their_speed_and_changes_are_limited() {
        let drive = Drive::new(RobotModel {
            acceleration: Some(1.0),
            angular_acceleration: Some(2.0),
            ..RobotModel::lego_nxt()
        });
        let clipped = drive.clip(Twist2::new(1.0, 100.0));
        assert!((clipped.v - 0.075).abs() < 1e-12);
        let next = drive.execute(Twist2::STOP, Twist2::new(0.15, 0.0), 0.05);
        assert!((next.v - 0.05).abs() < 1e-12);
        assert_eq!(drive.clip(Twist2::new(f64::NAN, 0.0)), Twist2::STOP);
        assert!((drive.braking_distance(0.1) - 0.005).abs() < 1e-12);
    }

    #[test]
    fn a_robot_that_brakes_keeps_its_speed_and_turns_less_where_a_wheel_would_be_too_fast() {
        // 0.15 m/s per wheel, 0.112 m apart; it can lose 0.05 m/s in a tick.
        let drive = Drive::new(RobotModel {
            acceleration: Some(1.0),
            ..RobotModel::lego_nxt()
        });
        let next = drive.execute(Twist2::new(0.15, 0.0), Twist2::new(0.0, 2.0), 0.05);
        assert!((next.v - 0.1).abs() < 1e-12, "{next:?}");
        assert!((next.omega - 0.05 / 0.056).abs() < 1e-12, "{next:?}");
    }
}
