//! What the robot's drive makes of commands.

use nalgebra::Vector2;
use sim_backend::math;
use sim_backend::pose::{Pose2, Twist2};
use sim_backend::spec::RobotModel;

/// The pose after keeping a twist for `dt` [s].
pub fn integrate(pose: &Pose2, twist: Twist2, dt: f64) -> Pose2 {
    let half = 0.5 * twist.omega * dt;
    // The chord of the arc lies in the direction of its middle.
    let sinc = if half.abs() < 1e-6 {
        1.0 - half * half / 6.0
    } else {
        math::sin(half) / half
    };
    let (sin, cos) = math::sincos(pose.theta + half);
    let chord = Vector2::new(cos, sin) * (twist.v * dt * sinc);
    Pose2::new(
        pose.x + chord.x,
        pose.y + chord.y,
        pose.theta + twist.omega * dt,
    )
}

/// The drive of a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    model: RobotModel,
}

impl Drive {
    /// The drive of a robot of this model.
    pub fn new(model: RobotModel) -> Self {
        Self { model }
    }

    /// Body and limits.
    pub fn model(&self) -> &RobotModel {
        &self.model
    }

    /// Highest speed straight ahead [m/s].
    pub fn top_speed(&self) -> f64 {
        let wheels = self.model.wheel_speed_max.unwrap_or(f64::INFINITY);
        self.model.v_max.min(wheels)
    }

    /// The command within the limits of the speeds: each by itself, then both together by what the
    /// wheels can do, which keeps the curvature. What is not finite becomes a stop.
    pub fn clip(&self, twist: Twist2) -> Twist2 {
        let model = &self.model;
        if !twist.is_finite() {
            return Twist2::STOP;
        }
        let v = twist.v.clamp(-model.v_reverse_max, model.v_max);
        let omega = twist.omega.clamp(-model.omega_max, model.omega_max);
        let fastest = v.abs() + 0.5 * omega.abs() * model.wheel_separation;
        match model.wheel_speed_max {
            Some(max) if fastest > max => Twist2::new(v * (max / fastest), omega * (max / fastest)),
            _ => Twist2::new(v, omega),
        }
    }

    /// What is executed of a command during `dt` [s] after `current` was.
    pub fn execute(&self, current: Twist2, command: Twist2, dt: f64) -> Twist2 {
        let mut twist = self.clip(command);
        if let Some(a) = self.model.acceleration {
            twist.v = twist.v.clamp(current.v - a * dt, current.v + a * dt);
        }
        if let Some(a) = self.model.angular_acceleration {
            let change = a * dt;
            twist.omega = twist
                .omega
                .clamp(current.omega - change, current.omega + change);
        }
        self.clip(twist)
    }

    /// Distance [m] that stopping takes from a speed [m/s] on.
    pub fn braking_distance(&self, speed: f64) -> f64 {
        self.model
            .acceleration
            .map_or(0.0, |a| speed * speed / (2.0 * a))
    }

    /// Most distance [m] that a robot which drives with `speed` [m/s] now can cover within `dt` [s]
    /// and while it stops afterwards.
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
    fn a_quarter_turn_ends_beside_and_ahead() {
        let quarter = core::f64::consts::FRAC_PI_2;
        let end = integrate(&Pose2::default(), Twist2::new(2.0 * quarter, quarter), 1.0);
        assert!((end.x - 2.0).abs() < 1e-12 && (end.y - 2.0).abs() < 1e-12);
        assert!((end.theta - quarter).abs() < 1e-12);
    }

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
}
