//! No faster than the robot can still stop before what it sees.
//!
//! A command is followed for the reaction time and the robot then stopped, with the ramps of its
//! drive: a turning rate that lags behind makes the way wider than the arc of the command, and a
//! robot that brakes still drives on. If no way that was looked at is clear, the robot stops at once
//! by the way of stopping that was clear before (dynamic window, Fox, Burgard and Thrun 1997).

use geometry::pose::{Pose2, Twist2};
use nalgebra::Vector2;

use super::DriverParams;
use crate::go_to::coast;
use crate::tangent_bug;

/// Parts of the commanded speed tried, one after the other; then the robot turns on the spot.
const SPEEDS: [f64; 9] = [1.0, 0.75, 0.55, 0.4, 0.28, 0.2, 0.14, 0.09, 0.05];
/// Most steps in which a way ahead is looked at; with shorter ticks a step is several of them.
const STEPS: f64 = 48.0;
/// How much nearer than now the robot may come to what is too near already (fraction).
const CREEP: f64 = 0.003;
/// A robot slower than this (m/s) stands.
const STANDING: f64 = 1e-6;

/// What a robot knows when its command is checked.
pub(super) struct Guard<'a> {
    /// Its direction (rad).
    pub(super) theta: f64,
    /// How it moves.
    pub(super) twist: Twist2,
    /// What it sees, relative to its centre in world axes (m).
    pub(super) echoes: &'a [Vector2<f64>],
    /// How far it sees (m).
    pub(super) range: f64,
    /// Its radius (m).
    pub(super) radius: f64,
    /// Length of a tick (s).
    pub(super) dt: f64,
    /// How it drives.
    pub(super) params: &'a DriverParams,
}

/// How a robot stops.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stop {
    /// It straightens out.
    Straight,
    /// It keeps turning as it does.
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

/// A step of a way looked at.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// Its length (s).
    length: f64,
    /// Share of a change of speed that counts for the whole step: the drive changes its speed at
    /// the beginning of each tick.
    weight: f64,
}

/// An echo, and how near the robot may come to it.
#[derive(Debug, Clone, Copy)]
struct Near {
    at: Vector2<f64>,
    least: f64,
}

impl Guard<'_> {
    /// The command, slowed down so that the robot stays clear of what it sees until it can stand.
    /// Its turning rate is kept, except where the robot has to stop at once: it turns on the spot if
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
        let near: Vec<Near> = self
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
                Near { at, least }
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

    /// Half of the margin is kept: the other half is for straying from the way that was found clear.
    fn keep(&self) -> f64 {
        self.radius + 0.5 * tangent_bug::MARGIN
    }

    /// Whether the robot can follow a command for the reaction time and stop after that.
    fn is_clear(&self, command: Twist2, step: Step, near: &[Near]) -> bool {
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

    /// Least room beyond what has to be kept while the robot stops (m); negative if it comes too
    /// near.
    fn room_to_stop(
        &self,
        stop: Stop,
        (mut pose, mut twist): (Pose2, Twist2),
        step: Step,
        near: &[Near],
    ) -> f64 {
        let command = stop.command(twist);
        let mut room = f64::INFINITY;
        // Without a deceleration it stands at once.
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

    /// A step under a command; the least room on the way.
    fn go(
        &self,
        pose: &mut Pose2,
        twist: &mut Twist2,
        command: Twist2,
        step: Step,
        near: &[Near],
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

    /// Room at a place beyond what has to be kept (m).
    fn room(&self, at: &Pose2, near: &[Near]) -> f64 {
        let at = at.position().coords;
        // What lies beyond the range may be a wall.
        let seen = (self.range - self.keep()).max(0.25 * self.radius) - at.norm();
        near.iter()
            .map(|echo| (at - echo.at).norm() - echo.least)
            .fold(seen, f64::min)
    }
}
