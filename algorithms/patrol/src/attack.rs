//! Adversaries of a patrol: each chooses place and time of its attacks from what it knows of the guards.
//!
//! An attack lasts for a given time. It fails if a guard detects it ([`metrics::detection::DetectionRule`]). Between two
//! attacks an adversary rests; then it attacks within a *window* of time:
//!
//! - [`Method::Random`]: at a place and a time of the window that are drawn evenly;
//! - [`Method::Statistical`]: at the place with the longest intervals between visits, as their mean less their standard
//!   deviation, at the moment at which a guard leaves it;
//! - [`Method::History`]: at the place that, by all visits so far, most probably remains without a visit, given the time
//!   since the last one; it waits for a moment as good as the best that the visits show for any place;
//! - [`Method::BestResponse`]: it knows how the guards make their zig-zags, but not their keys
//!   ([`BestResponse`]); it chooses again if a guard is at the place at the chosen time.
//!
//! At the end of its window an adversary attacks in any case, where its method finds the best place then.

mod best_response;
mod visits;

use metrics::detection::DetectionRule;
use nalgebra::Point2;
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contour::Contour;

pub use best_response::BestResponse;
pub use visits::Visits;

/// Way in which an adversary chooses place and time.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Place and time at random.
    Random,
    /// The place and moment most probably without a visit, by all visits so far.
    History,
    /// The place with the longest intervals between visits, when a guard leaves it.
    Statistical,
    /// The place and time least probably guarded, by the guards' method with other keys.
    BestResponse,
}

/// Times of the attacks of an adversary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Schedule {
    /// Duration of an attack (s), > 0.
    pub duration_s: f64,
    /// Begin of its first window (s), ≥ 0: until then it watches.
    pub first_s: f64,
    /// Time from the end of an attack to the next window (s), ≥ 0.
    pub pause_s: f64,
    /// Length of a window (s), ≥ 0.
    pub window_s: f64,
}

/// Place and time of a planned attack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Index of the place.
    pub place: usize,
    /// Time until it begins (s).
    pub delay_s: f64,
}

/// An adversary with one method.
#[derive(Debug, Clone)]
pub struct Adversary {
    method: Method,
    schedule: Schedule,
    ready_s: f64,
    /// Place and time of its next attack (s).
    planned: Option<(usize, f64)>,
    rng: ChaCha8Rng,
}

impl Adversary {
    /// Creates it; random numbers come from its own stream.
    pub fn new(method: Method, schedule: Schedule, rng: ChaCha8Rng) -> Self {
        Self {
            method,
            schedule,
            ready_s: schedule.first_s,
            planned: None,
            rng,
        }
    }

    /// Its method.
    pub fn method(&self) -> Method {
        self.method
    }

    /// Returns the index of the place that it attacks at this time (s), if it does. `visits` is up to date; `plan` computes
    /// a best response within a time from now on (s), and is called for no other method: once per attack, and again if a
    /// guard is at the place at the chosen time.
    pub fn step(
        &mut self,
        time_s: f64,
        visits: &Visits,
        plan: impl FnOnce(&mut ChaCha8Rng, f64) -> Option<Plan>,
    ) -> Option<usize> {
        let Schedule {
            duration_s,
            window_s,
            pause_s,
            ..
        } = self.schedule;
        if time_s < self.ready_s || visits.places() == 0 {
            return None;
        }
        let rest_s = (self.ready_s + window_s - time_s).max(0.0);
        let is_last_moment = rest_s <= 0.0;
        let place = match self.method {
            Method::Statistical => {
                let place = visits.longest();
                let is_moment = place.is_some_and(|place| visits.is_left_now(place));
                let place = place.unwrap_or_else(|| self.rng.random_range(0..visits.places()));
                (is_moment || is_last_moment).then_some(place)?
            }
            Method::History => {
                let (place, chance) = visits.most_open(duration_s)?;
                let is_moment = chance > 0.0 && chance >= visits.best_chance(duration_s);
                (is_moment || is_last_moment).then_some(place)?
            }
            Method::Random | Method::BestResponse => {
                let is_response = self.method == Method::BestResponse;
                let planned = self.planned.filter(|&(place, at_s)| {
                    !is_response || time_s < at_s || !visits.is_guarded(place)
                });
                let (place, at_s) = planned.unwrap_or_else(|| {
                    let response = is_response.then(|| plan(&mut self.rng, rest_s)).flatten();
                    let plan = response.unwrap_or_else(|| Plan {
                        place: self.rng.random_range(0..visits.places()),
                        delay_s: rest_s * self.rng.random::<f64>(),
                    });
                    (plan.place, time_s + plan.delay_s)
                });
                self.planned = Some((place, at_s));
                (time_s >= at_s || is_last_moment).then_some(place)?
            }
        };
        self.planned = None;
        self.ready_s = time_s + duration_s + pause_s;
        Some(place)
    }
}

/// The places of a contour at equal distances, as near as its length allows to `step` (m), > 0.
pub fn places_along(contour: &Contour, step: f64) -> Vec<Point2<f64>> {
    let parts = (contour.length() / step).round().max(1.0) as usize;
    let count = if contour.is_closed() {
        parts
    } else {
        parts + 1
    };
    let place = |number: usize| contour.at(number as f64 / parts as f64);
    (0..count).filter_map(place).collect()
}

/// Returns for each place whether one of the guards detects an attack there (m).
pub fn guarded(
    places: &[Point2<f64>],
    guards: &[Point2<f64>],
    rule: DetectionRule,
    is_visible: impl Fn(Point2<f64>, Point2<f64>) -> bool,
) -> Vec<bool> {
    let detects = |place, guard| rule.detects(place, guard, &is_visible);
    let is_guarded = |&place| guards.iter().any(|&guard| detects(place, guard));
    places.iter().map(is_guarded).collect()
}

#[cfg(test)]
mod tests;
