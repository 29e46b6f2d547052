//! Assembly of a trajectory from parts: turns on the spot and paths with speeds.

use core::f64::consts::PI;

use geometry::math;
use geometry::pose::Pose2;
use nalgebra::Point2;

use crate::drive::turn_in_place;
use crate::path_points::PathPoint;
use crate::plan::Sample;
use trajectory_problem::{Problem, RobotLimits};

/// Maximum turn (rad) between two samples on the spot.
const TURN_SPACING: f64 = 0.1;

/// Maximum number of samples of a turn on the spot: that of a robot that cannot turn within any finite
/// time would have no end.
const MAX_TURN_SAMPLES: f64 = 1e4;

/// Speeds (m/s, rad/s) that differ by less are equal.
const SAME: f64 = 1e-9;

/// Direction in which the robot drives along a path.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Direction {
    /// Sign of the forward speed.
    sign: f64,
    /// Angle (rad) from the heading to the direction of travel.
    turned: f64,
}

impl Direction {
    const FORWARDS: Self = Self {
        sign: 1.0,
        turned: 0.0,
    };
    const BACKWARDS: Self = Self {
        sign: -1.0,
        turned: PI,
    };
}

/// A trajectory under construction.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    samples: Vec<Sample>,
    /// Length of the path so far (m).
    length: f64,
}

impl Trajectory {
    /// Creates a trajectory of a robot that has not moved yet; its speeds are those of its first
    /// part.
    pub fn from_start(start: &Pose2) -> Self {
        Self {
            samples: vec![Sample {
                t: 0.0,
                x: start.x,
                y: start.y,
                theta: start.theta,
                v: 0.0,
                omega: 0.0,
            }],
            length: 0.0,
        }
    }

    /// Creates a trajectory from samples (at least one).
    pub fn from_samples(samples: Vec<Sample>) -> Self {
        let chords = samples
            .windows(2)
            .map(|pair| math::hypot(pair[1].x - pair[0].x, pair[1].y - pair[0].y));
        Self {
            length: chords.sum(),
            samples,
        }
    }

    /// The samples so far (at least one).
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// The samples.
    pub fn into_samples(self) -> Vec<Sample> {
        self.samples
    }

    /// Duration so far (s).
    pub fn duration(&self) -> f64 {
        self.samples.last().map_or(0.0, |last| last.t)
    }

    /// Length of the path so far (m).
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Heading at the end (rad).
    pub fn heading(&self) -> f64 {
        self.samples.last().map_or(0.0, |last| last.theta)
    }

    /// Sets the speeds (m/s, rad/s) with which the robot arrives at the start: a step follows if
    /// its first part begins with others.
    pub fn arrive_with(&mut self, v: f64, omega: f64) {
        if let Some(first) = self.samples.first_mut()
            && differ((first.v, first.omega), (v, omega))
        {
            let after = *first;
            (first.v, first.omega) = (v, omega);
            self.samples.insert(1, after);
        }
    }

    /// Sets the final speeds (m/s, rad/s): by a step, if the last part ends with others.
    pub fn leave_with(&mut self, v: f64, omega: f64) {
        if let Some(&last) = self.samples.last()
            && differ((last.v, last.omega), (v, omega))
        {
            self.samples.push(Sample { v, omega, ..last });
        }
    }

    /// Adds a turn on the spot by an angle (rad).
    pub fn turn(&mut self, limits: &RobotLimits, angle: f64) {
        self.turn_phases(&turn_in_place::phases(limits, angle));
    }

    fn turn_phases(&mut self, phases: &[turn_in_place::Phase]) {
        for phase in phases {
            let Some(&begin) = self.samples.last() else {
                return;
            };
            self.step_to(0.0, phase.from);
            let turned = 0.5 * (phase.from + phase.to) * phase.duration;
            let count = (turned.abs() / TURN_SPACING)
                .ceil()
                .clamp(1.0, MAX_TURN_SAMPLES);
            for i in 1..=count as usize {
                let part = i as f64 / count;
                let t = part * phase.duration;
                let omega = phase.from + (phase.to - phase.from) * part;
                self.samples.push(Sample {
                    t: begin.t + t,
                    theta: begin.theta + 0.5 * (phase.from + omega) * t,
                    v: 0.0,
                    omega,
                    ..begin
                });
            }
        }
    }

    /// Adds a turn on the spot whose rate fades linearly from `omega` (rad/s) to 0.
    pub fn fade(&mut self, omega: f64, duration: f64) {
        self.turn_phases(&[turn_in_place::Phase {
            duration,
            from: omega,
            to: 0.0,
        }]);
    }

    /// Adds a path that begins where the trajectory ends, with the speeds (m/s) at its points.
    /// Between two points V changes linearly in time.
    pub fn drive(&mut self, points: &[PathPoint], speeds: &[f64]) {
        self.drive_along(points, speeds, Direction::FORWARDS);
    }

    /// Adds a path that the robot drives backwards, with the magnitudes of its speeds (m/s).
    pub fn drive_backwards(&mut self, points: &[PathPoint], speeds: &[f64]) {
        self.drive_along(points, speeds, Direction::BACKWARDS);
    }

    fn drive_along(&mut self, points: &[PathPoint], speeds: &[f64], direction: Direction) {
        let (Some(first), Some(&v)) = (points.first(), speeds.first()) else {
            return;
        };
        let Direction { sign, turned } = direction;
        self.step_to(sign * v, v * first.kappa);
        let mut t = self.duration();
        for (pair, v) in points.windows(2).zip(speeds.windows(2)) {
            let (a, b) = (&pair[0], &pair[1]);
            let ds = b.s - a.s;
            if ds <= 0.0 {
                self.step_to(sign * v[1], v[1] * b.kappa);
                continue;
            }
            t += 2.0 * ds / (v[0] + v[1]);
            self.samples.push(Sample {
                t,
                x: b.at.x,
                y: b.at.y,
                theta: b.theta - turned,
                v: sign * v[1],
                omega: v[1] * b.kappa,
            });
            self.length += ds;
        }
    }

    /// Sets the end exactly to the goal (m) and, if given, to its heading (rad), which removes
    /// rounding errors.
    pub fn settle(&mut self, goal: Point2<f64>) {
        if let Some(last) = self.samples.last_mut() {
            (last.x, last.y) = (goal.x, goal.y);
        }
    }

    /// Sets the initial and final speeds that a problem prescribes: by steps, where they differ.
    pub fn keep_ends(&mut self, problem: &Problem) {
        // Where V steps and no ω is prescribed, ω is 0 if it can step, too: every V is compatible
        // with that.
        let beside = |own: f64, asked: f64, omega: f64| {
            let steps = (own - asked).abs() > SAME && problem.limits.angular_acceleration.is_none();
            if steps { 0.0 } else { omega }
        };
        if let Some(&first) = self.samples.first() {
            let v = problem.start_speed.unwrap_or(first.v);
            let free = beside(first.v, v, first.omega);
            self.arrive_with(v, problem.start_turn_rate.unwrap_or(free));
        }
        if let (Some(v), Some(&last)) = (problem.goal_speed, self.samples.last()) {
            self.leave_with(v, beside(last.v, v, last.omega));
        }
    }

    /// Appends a step of the speeds at the end, if they differ. The speeds of a single first sample
    /// are replaced: the robot begins with these.
    fn step_to(&mut self, v: f64, omega: f64) {
        let only = self.samples.len() == 1;
        let Some(last) = self.samples.last_mut() else {
            return;
        };
        if !differ((last.v, last.omega), (v, omega)) {
            return;
        }
        if only {
            (last.v, last.omega) = (v, omega);
        } else {
            let next = Sample { v, omega, ..*last };
            self.samples.push(next);
        }
    }
}

/// Returns `true` if two pairs of speeds (m/s, rad/s) differ by more than rounding.
fn differ(a: (f64, f64), b: (f64, f64)) -> bool {
    (a.0 - b.0).abs() > SAME || (a.1 - b.1).abs() > SAME
}
