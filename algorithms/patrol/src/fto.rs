//! Fictive temporary obstacles (FTO): discs that do not exist, which the robot avoids as if they did.
//!
//! The baseline of the cat-map patrol paper (§5.2), which gives its times, its logistic map and its
//! first value, but not the placement of the obstacles. This is a *reconstruction*:
//!
//! - each quantity takes a step of the logistic map z ← r·z·(1 − z);
//! - after 2 + 18·z seconds without one, a disc appears for 0.3 + 2.2·z seconds, at rest;
//! - it appears ahead of the robot, wholly beyond its body and with its near edge within the reach
//!   of its sensor, half a radius to the left for z > ½, to the right otherwise.
//!
//! The disc is added to the robot's range scan ([`merged`]), so that every method that avoids real
//! obstacles avoids it too and sees both at once. A fictive obstacle never drives the robot into a
//! real one. An observer that knows the logistic map predicts it from two values; a key of another
//! kind can be used instead.

mod disc;
mod params;

use chaotic_maps::{AnySource, Source as _};
use geometry::pose::Pose2;
use nalgebra::Point2;
use parameters::{ParamsError, check};

pub use disc::{Disc, merged};
pub use params::FtoParams;

/// First value of the paper's logistic map.
const Z0: f64 = 0.18;

/// Parameter of the paper's logistic map.
const R: f64 = 3.99;

/// Minimum and maximum time without an obstacle (s).
const GAP_S: [f64; 2] = [2.0, 20.0];

/// Clearance between an obstacle and the robot's body at its goal (m).
const GOAL_GAP: f64 = 0.1;

/// State of the robot that avoids the obstacles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Carrier {
    /// Pose.
    pub pose: Pose2,
    /// Radius of its body (m).
    pub radius: f64,
    /// Range of its sensor from its centre (m).
    pub reach: f64,
    /// The next target point (m); a fictive obstacle never hides it.
    pub goal: Option<Point2<f64>>,
}

/// Source of the numbers.
#[derive(Debug, Clone)]
enum NumberSource {
    Logistic(f64),
    Keyed(Box<AnySource>),
}

impl NumberSource {
    /// The next number, in [0, 1].
    fn next(&mut self) -> f64 {
        match self {
            Self::Logistic(z) => {
                *z = R * *z * (1.0 - *z);
                *z
            }
            Self::Keyed(source) => source.next_unit()[0],
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    /// No number has been drawn yet.
    New,
    /// No obstacle until then (s).
    Gap(f64),
    /// An obstacle until then (s).
    Active(Disc, f64),
    /// An obstacle that was removed early; its time ends then (s).
    Withdrawn(f64),
}

/// The fictive obstacles of one robot, one at a time.
#[derive(Debug, Clone)]
pub struct Fto {
    params: FtoParams,
    numbers: NumberSource,
    phase: Phase,
}

impl Fto {
    /// Starts without an obstacle.
    ///
    /// # Errors
    /// [`ParamsError`] naming the parameter that is out of range, or the invalid key.
    pub fn new(params: &FtoParams) -> Result<Self, ParamsError> {
        check(params)?;
        let numbers = match &params.key {
            None => NumberSource::Logistic(Z0),
            Some(key) => NumberSource::Keyed(Box::new(key.source()?)),
        };
        Ok(Self {
            params: params.clone(),
            numbers,
            phase: Phase::New,
        })
    }

    /// The obstacle at a time (s), if there is one; call once per tick.
    ///
    /// The times of obstacles depend on time alone, their positions on the robot. An obstacle that
    /// touches the robot's body, or hides its goal, is not shown: it would block the robot or make a
    /// real place look unreachable.
    pub fn at(&mut self, time_s: f64, carrier: &Carrier) -> Option<Disc> {
        if !time_s.is_finite() || !carrier.pose.is_finite() {
            return None;
        }
        match self.phase {
            Phase::New => self.begin_gap(time_s),
            Phase::Gap(until) if time_s >= until => self.appear(until, carrier),
            Phase::Active(_, until) | Phase::Withdrawn(until) if time_s >= until => {
                self.begin_gap(until);
            }
            _ => {}
        }
        if let Phase::Active(disc, until) = self.phase
            && is_in_the_way(&disc, carrier)
        {
            self.phase = Phase::Withdrawn(until);
        }
        match self.phase {
            Phase::Active(disc, _) => Some(disc),
            _ => None,
        }
    }

    fn begin_gap(&mut self, from_s: f64) {
        let [low, high] = GAP_S;
        self.phase = Phase::Gap(from_s + low + (high - low) * self.numbers.next());
    }

    fn appear(&mut self, from_s: f64, carrier: &Carrier) {
        let [low, high] = self.params.active_s;
        let until = from_s + low + (high - low) * self.numbers.next();
        let side = if self.numbers.next() > 0.5 { 1.0 } else { -1.0 };
        let share = self.params.nearest + (1.0 - self.params.nearest) * self.numbers.next();
        let near = carrier.radius + share * (carrier.reach - carrier.radius).max(0.0);
        let radius = self.params.radius;
        let heading = carrier.pose.theta;
        let (sin, cos) = geometry::math::sincos(heading);
        let (ahead, left) = (near + radius, 0.5 * side * radius);
        let center = Point2::new(
            carrier.pose.x + cos * ahead - sin * left,
            carrier.pose.y + sin * ahead + cos * left,
        );
        self.phase = Phase::Active(Disc { center, radius }, until);
    }
}

/// Returns `true` if a disc touches the robot's body, or its goal lies within the reach of it.
fn is_in_the_way(disc: &Disc, carrier: &Carrier) -> bool {
    let clear = disc.radius + carrier.radius;
    let near = |p: Point2<f64>, gap: f64| (p - disc.center).norm() <= clear + gap;
    near(carrier.pose.position(), 0.0) || carrier.goal.is_some_and(|goal| near(goal, GOAL_GAP))
}

#[cfg(test)]
mod tests;
