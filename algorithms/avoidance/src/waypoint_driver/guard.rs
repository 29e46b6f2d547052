//! Speed limit: the robot can always stop before the obstacles that it sees.
//!
//! The robot follows a command for the reaction time and then stops, with the ramps of its drive. A
//! turning rate that lags makes the path wider than the arc of the command, and a braking robot
//! still moves. If no tested path is clear, the robot stops at once by the stop that was clear
//! before (dynamic window, Fox, Burgard and Thrun 1997).

use geometry::pose::{Pose2, Twist2};
use nalgebra::Vector2;

use super::DriverParams;
use crate::tangent_bug;
use control::go_to::coast;

/// Fractions of the commanded speed, tried in order; then the robot turns on the spot.
const SPEEDS: [f64; 9] = [1.0, 0.75, 0.55, 0.4, 0.28, 0.2, 0.14, 0.09, 0.05];
/// Maximum number of steps of a tested path; with shorter ticks a step spans several.
const STEPS: f64 = 48.0;
/// Fraction by which the robot may still approach an obstacle that is already too near.
const CREEP: f64 = 0.003;
/// Speed (m/s) below which a robot stands.
const STANDING: f64 = 1e-6;

/// State of the robot when its command is checked.
pub struct Guard<'a> {
    /// Heading (rad).
    pub(super) theta: f64,
    /// Current twist.
    pub(super) twist: Twist2,
    /// Echoes, relative to the robot's centre in world axes (m).
    pub(super) echoes: &'a [Vector2<f64>],
    /// Range of the sensor (m).
    pub(super) range: f64,
    /// Radius of the robot (m).
    pub(super) radius: f64,
    /// Length of a tick (s).
    pub(super) dt: f64,
    /// Parameters of the driver.
    pub(super) params: &'a DriverParams,
}

/// Manner of stopping.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stop {
    /// The robot straightens out.
    Straight,
    /// The robot keeps turning while it stops.
    Turning,
}

impl Stop {
    const ALL: [Self; 2] = [Self::Straight, Self::Turning];

    fn command(self, twist: Twist2) -> Twist2 {
        match self {
            Self::Straight => Twist2::STOP,
            Self::Turning => Twist2::new(0.0, twist.omega),
        }
    }
}

/// A step of a tested path.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// Duration (s).
    length: f64,
    /// Share of a change of speed that counts for the whole step: the drive changes its speed at the
    /// beginning of each tick.
    weight: f64,
}

/// An echo, and its minimum distance from the robot.
#[derive(Debug, Clone, Copy)]
struct NearEcho {
    at: Vector2<f64>,
    least: f64,
}

impl Guard<'_> {
    /// Slows the command down so that the robot stays clear of what it sees until it can stop. Its
    /// turning rate is kept, except where the robot must stop at once: it turns on the spot if
    /// nothing faster is clear.
    pub(super) fn slow_down(&self, command: Twist2) -> Twist2 {
        let coasts = self.params.braking.is_some() && self.twist.v > STANDING;
        if command.v <= 0.0 && !coasts {
            return command;
        }
        let top = command.v.max(if coasts { self.twist.v } else { 0.0 });
        let braking_s = self.params.braking.map_or(0.0, |a| top / a);
        let ticks = (self.params.reaction_s + braking_s) / self.dt;
        let per_step = (ticks / STEPS).ceil().max(1.0);
        let step = Step {
            length: per_step * self.dt,
            weight: (per_step + 1.0) / (2.0 * per_step),
        };
        let keep = self.keep();
        let farthest = top * (self.params.reaction_s + step.length + 0.5 * braking_s) + keep;
        let near: Vec<NearEcho> = self
            .echoes
            .iter()
            .filter(|echo| echo.norm_squared() <= farthest * farthest)
            .map(|&at| {
                let now = at.norm();
                let least = if now < keep {
                    (now * (1.0 - CREEP)).max(self.radius).min(now)
                } else {
                    keep
                };
                NearEcho { at, least }
            })
            .collect();
        let tried = SPEEDS
            .iter()
            .map(|part| Twist2::new(command.v.max(0.0) * part, command.omega))
            .chain([Twist2::new(0.0, command.omega)]);
        for twist in tried {
            if self.is_clear(twist, step, &near) {
                return twist;
            }
        }
        if !coasts {
            return Twist2::new(0.0, command.omega);
        }
        let start = Pose2::new(0.0, 0.0, self.theta);
        let room = |stop: &Stop| self.room_to_stop(*stop, (start, self.twist), step, &near);
        let [straight, turning] = Stop::ALL;
        let best = if room(&turning) > room(&straight) {
            turning
        } else {
            straight
        };
        best.command(self.twist)
    }

    /// Half of the margin is kept: the other half covers deviations from the path that was found
    /// clear.
    fn keep(&self) -> f64 {
        self.radius + 0.5 * tangent_bug::MARGIN
    }

    /// Returns `true` if the robot can follow a command for the reaction time and stop after that.
    fn is_clear(&self, command: Twist2, step: Step, near: &[NearEcho]) -> bool {
        let mut pose = Pose2::new(0.0, 0.0, self.theta);
        let mut twist = self.twist;
        let mut time = 0.0;
        while time < self.params.reaction_s - 1e-9 {
            if self.go(&mut pose, &mut twist, command, step, near) < 0.0 {
                return false;
            }
            time += step.length;
        }
        Stop::ALL
            .into_iter()
            .any(|stop| self.room_to_stop(stop, (pose, twist), step, near) >= 0.0)
    }

    /// Minimum clearance in excess of the required one while the robot stops (m); negative if it
    /// comes too near.
    fn room_to_stop(
        &self,
        stop: Stop,
        (mut pose, mut twist): (Pose2, Twist2),
        step: Step,
        near: &[NearEcho],
    ) -> f64 {
        let command = stop.command(twist);
        let mut room = f64::INFINITY;
        // Without a deceleration it stops at once.
        let Some(braking) = self.params.braking else {
            return room;
        };
        let steps = (twist.v.abs() / (braking * step.length))
            .ceil()
            .min(2.0 * STEPS);
        let mut done = 0.0;
        while done < steps {
            room = room.min(self.go(&mut pose, &mut twist, command, step, near));
            done += 1.0;
        }
        room
    }

    /// Simulates a step under a command; returns the minimum clearance on the path.
    fn go(
        &self,
        pose: &mut Pose2,
        twist: &mut Twist2,
        command: Twist2,
        step: Step,
        near: &[NearEcho],
    ) -> f64 {
        let ramp = |now: f64, wanted: f64, rate: Option<f64>| match rate {
            None => (wanted, wanted),
            Some(rate) => {
                let most = rate * step.length;
                let after = wanted.clamp(now - most, now + most);
                (now + (after - now) * step.weight, after)
            }
        };
        let (v, v_after) = ramp(twist.v, command.v, self.params.braking);
        let (omega, omega_after) =
            ramp(twist.omega, command.omega, self.params.angular_acceleration);
        let during = Twist2::new(v, omega);
        let halfway = coast(pose, during, 0.5 * step.length);
        *pose = coast(pose, during, step.length);
        *twist = Twist2::new(v_after, omega_after);
        self.room(&halfway, near).min(self.room(pose, near))
    }

    /// Clearance at a place in excess of the required one (m).
    fn room(&self, at: &Pose2, near: &[NearEcho]) -> f64 {
        let at = at.position().coords;
        // Space beyond the range may be a wall.
        let seen = (self.range - self.keep()).max(0.25 * self.radius) - at.norm();
        near.iter()
            .map(|echo| (at - echo.at).norm() - echo.least)
            .fold(seen, f64::min)
    }
}
