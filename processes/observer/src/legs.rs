//! Detection of the goals that a robot has reached, from its poses alone.
//!
//! A robot that drives from goal to goal drives straight legs; each aims at its goal to the end. It
//! turns away as soon as the goal is within its tolerance. Where a straight leg ends, the goal
//! therefore lies ahead by that tolerance, less half the distance of a tick on average. The turn
//! that follows does not matter.
//!
//! Goals that are near to each other leave no straight leg between them. There the turning rate
//! shows the goals: a robot that turns towards its goal turns ever more slowly. When it turns
//! faster again, or the other way, it has a new goal.

use std::collections::VecDeque;

use geometry::math;
use nalgebra::{Point2, Vector2};

use crate::moment::{Look, MeasuredPose, ReachedGoal};

/// Lower bound of significant changes of heading (rad).
const MIN_TURN: f64 = 0.02;
/// The same in standard deviations of the heading.
const TURN_SIGMAS: f64 = 5.0;
/// Factor of the minimum turn at the end of a short leg.
const CLEAR_TURN: f64 = 2.0;
/// Poses of a short leg.
const SHORT: usize = 4;
/// Changes of the turning rate per observation that exceed noise, in standard deviations of the
/// heading: a change takes three of them.
const JUMP_SIGMAS: f64 = 8.0;
/// Minimum length of a leg of poses with one heading (m); a further part is in standard deviations.
const MIN_LEG: f64 = 0.01;
const LEG_SIGMAS: f64 = 4.0;
/// Number of poses that are averaged at a leg's end.
const END: usize = 8;
/// Number of poses after which any straight motion counts as a leg.
const SETTLED: usize = 20;
/// Number of poses that determine the heading of a leg.
const HEADINGS: usize = 5;
/// Noise below which the last position is better than an average (m).
const EXACT: f64 = 1e-3;

/// Error of a goal in standard deviations of a position, and without noise (m).
const NOISE_KEPT: f64 = 1.2;
const MIN_ERROR: f64 = 0.003;

#[derive(Debug, Clone, Copy)]
struct Sample {
    time: f64,
    seen: MeasuredPose,
}

/// Returns the goal that was reached with this sample, after a tick of this distance (m).
fn reached(sample: Sample, point: Point2<f64>, way: f64) -> ReachedGoal {
    // Uniform within the distance of a tick: way²/12 along it.
    let noise = NOISE_KEPT * sample.seen.sigma;
    let variance = way * way / 24.0 + noise * noise + MIN_ERROR * MIN_ERROR;
    ReachedGoal {
        time: sample.time,
        point,
        sd: variance.sqrt(),
    }
}

/// Detects the legs of one robot.
#[derive(Debug, Clone)]
pub struct Legs {
    /// Distance from its goal at which the robot turns to the next (m).
    arrival: f64,
    /// The last poses with one heading, oldest first.
    samples: VecDeque<Sample>,
    /// `true` if they make a leg.
    straight: bool,
    /// Poses since the possible start of the leg.
    age: usize,
    /// Outlier: the first pose of a turn, or a bad measurement.
    odd: Option<Sample>,
    /// Last two poses in sight, the newer first.
    before: Option<(Sample, Option<Sample>)>,
    /// `true` if the robot has turned more slowly since the last goal.
    slowing: bool,
    /// The last goal (m).
    last: Option<Point2<f64>>,
    lost: bool,
}

impl Legs {
    /// Returns a detector for a robot that turns to its next goal within `arrival` (m), ≥ 0, of the
    /// last.
    pub fn new(arrival: f64) -> Self {
        Self {
            arrival,
            samples: VecDeque::new(),
            straight: false,
            age: 0,
            odd: None,
            before: None,
            slowing: false,
            last: None,
            lost: false,
        }
    }

    /// Processes an observation; returns the goal that the robot has turned away from.
    pub fn observe(&mut self, look: &Look) -> Option<ReachedGoal> {
        let Some(seen) = look.seen else {
            self.lost = true;
            self.before = None;
            self.slowing = false;
            self.restart(&[]);
            return None;
        };
        let sample = Sample {
            time: look.time,
            seen,
        };
        let goal = self.take(sample, look.dt);
        let newest = self.before.map(|(newest, _)| newest);
        self.before = Some((sample, newest));
        if let Some(goal) = goal {
            self.last = Some(goal.point);
            self.slowing = false;
        }
        goal
    }

    fn take(&mut self, sample: Sample, dt: f64) -> Option<ReachedGoal> {
        let jump = self.jumps(&sample);
        let turned = self.turned(&sample);
        if jump
            && self.odd.is_none()
            && let Some(goal) = self.goal_before_jump(dt)
        {
            self.restart(&[sample]);
            return Some(goal);
        }
        if turned > 1.0 {
            if !self.straight {
                self.restart(&[sample]);
                return None;
            }
            let Some(first) = self.odd else {
                self.odd = Some(sample);
                return None;
            };
            // An apparent leg may be the end of the turn before, which slows down.
            let settled = self.age >= SETTLED || (self.age >= SHORT && turned > CLEAR_TURN);
            let goal = settled.then(|| self.goal(dt)).flatten();
            self.restart(&[first]);
            if self.turned(&sample) > 1.0 {
                self.restart(&[]);
            }
            self.samples.push_back(sample);
            return goal;
        }
        self.odd = None;
        if self.samples.len() == END {
            self.samples.pop_front();
        }
        self.samples.push_back(sample);
        self.age += 1;
        if let Some(first) = self.samples.front() {
            let way = (sample.seen.position - first.seen.position).norm();
            self.straight |= way > MIN_LEG + LEG_SIGMAS * sample.seen.sigma;
        }
        None
    }

    /// Returns `true` if the robot has been out of sight since the last call: goals may be missing.
    pub fn take_lost(&mut self) -> bool {
        core::mem::take(&mut self.lost)
    }

    fn restart(&mut self, with: &[Sample]) {
        self.samples.clear();
        self.samples.extend(with);
        self.age = with.len();
        self.straight = false;
        self.odd = None;
    }

    /// Returns the mean heading of the leg's end (rad).
    fn heading(&self) -> f64 {
        let Some(last) = self.samples.back() else {
            return 0.0;
        };
        let heading = last.seen.heading;
        let count = self.samples.len().min(HEADINGS);
        let off: f64 = self
            .samples
            .iter()
            .rev()
            .take(count)
            .map(|sample| math::angle_difference(sample.seen.heading, heading))
            .sum();
        heading + off / count as f64
    }

    /// Returns the deviation of a heading from that of the leg, in changes that exceed noise; 0 if
    /// there is no leg.
    fn turned(&self, sample: &Sample) -> f64 {
        if self.samples.is_empty() {
            return 0.0;
        }
        let off = math::angle_difference(sample.seen.heading, self.heading());
        off.abs() / MIN_TURN.max(TURN_SIGMAS * sample.seen.heading_sigma)
    }

    /// Returns `true` if the robot suddenly turns faster, or the other way.
    fn jumps(&mut self, sample: &Sample) -> bool {
        let Some((newest, Some(older))) = self.before else {
            return false;
        };
        let turn =
            |from: &Sample, to: &Sample| math::angle_difference(to.seen.heading, from.seen.heading);
        let (was, is) = (turn(&older, &newest), turn(&newest, sample));
        let least = MIN_TURN.max(JUMP_SIGMAS * sample.seen.heading_sigma);
        let same_way = if was < 0.0 { -is } else { is };
        let jump = self.slowing && (same_way > was.abs() + least || same_way < -least);
        self.slowing |= is.abs() < least || is.abs() < was.abs() - 0.5 * least;
        jump
    }

    /// Returns the goal of a robot that has begun to turn at the last pose.
    fn goal_before_jump(&self, dt: f64) -> Option<ReachedGoal> {
        if self.straight && self.age >= END {
            return self.goal(dt);
        }
        let (newest, older) = self.before?;
        let way = (newest.seen.position - older?.seen.position).norm();
        let (sin, cos) = math::sincos(newest.seen.heading);
        let point = newest.seen.position + Vector2::new(cos, sin) * (self.arrival - 0.5 * way);
        let apart = self
            .last
            .is_none_or(|last| (point - last).norm() > self.arrival);
        apart.then(|| reached(newest, point, way))
    }

    /// Returns the goal at the end of the present leg.
    fn goal(&self, dt: f64) -> Option<ReachedGoal> {
        let last = self.samples.back()?;
        let (end, velocity) = self.end()?;
        let (sin, cos) = math::sincos(self.heading());
        let way = velocity.norm() * dt;
        let ahead = self.arrival - 0.5 * way;
        Some(reached(*last, end + Vector2::new(cos, sin) * ahead, way))
    }

    /// Returns the last position (m) and the velocity (m/s) of the leg's end, by least squares in
    /// time.
    fn end(&self) -> Option<(Point2<f64>, Vector2<f64>)> {
        let last = self.samples.back()?;
        let n = self.samples.len() as f64;
        let (mut time, mut way) = (0.0, Vector2::zeros());
        for sample in &self.samples {
            time += (sample.time - last.time) / n;
            way += (sample.seen.position - last.seen.position) / n;
        }
        let (mut squares, mut products) = (0.0, Vector2::zeros());
        for sample in &self.samples {
            let t = sample.time - last.time - time;
            squares += t * t;
            products += (sample.seen.position - last.seen.position - way) * t;
        }
        if squares <= 0.0 {
            return None;
        }
        let velocity = products / squares;
        let end = if last.seen.sigma < EXACT {
            last.seen.position
        } else {
            last.seen.position + way - velocity * time
        };
        Some((end, velocity))
    }
}
