//! Best response to keyed patrols of a contour: the method is known, the keys are not.
//!
//! The adversary sees where the guards are. It draws keys, and lets the guards' own method continue from their places of
//! the contour with each of them ([`Forecast`]). The share of the keys with which a guard detects an attack
//! estimates the probability of its detection.

use chaotic_maps::{Key, KeyKind};
use geometry::pose::Pose2;
use metrics::detection::DetectionRule;
use nalgebra::Point2;
use rand::Rng as _;
use rand_chacha::ChaCha8Rng;

use super::{Plan, Schedule, guarded};
use crate::awg::Awg;
use crate::forecast::Forecast;

/// Time between two forecasts (s).
const STEP_S: f64 = 0.5;

/// Knowledge of an adversary.
#[derive(Debug, Clone)]
pub struct BestResponse {
    /// The zig-zag of the guards.
    pub awg: Awg,
    /// Number of keys that are drawn for each attack, ≥ 1.
    pub samples: u32,
}

impl BestResponse {
    /// Returns the place and time in a window from now on at which the fewest keys lead to a detection, of equals the
    /// earliest; `None` without guards or places. `guards` are the poses of the guards.
    pub fn plan(
        &self,
        guards: &[Pose2],
        places: &[Point2<f64>],
        (schedule, rule): (&Schedule, DetectionRule),
        is_visible: impl Fn(Point2<f64>, Point2<f64>) -> bool,
        rng: &mut ChaCha8Rng,
    ) -> Option<Plan> {
        if guards.is_empty() || places.is_empty() {
            return None;
        }
        let steps = |time_s: f64| (time_s / STEP_S).ceil() as usize;
        let (delays, lasting) = (steps(schedule.window_s) + 1, steps(schedule.duration_s));
        let mut detected = vec![0_u32; delays * places.len()];
        // Number of the forecast at which each place is guarded next.
        let mut next = vec![usize::MAX; places.len()];
        for _ in 0..self.samples {
            let forecasts: Vec<(Forecast, f64)> = guards
                .iter()
                .filter_map(|seen| {
                    let source = Key::from_seed(KeyKind::Keyed, rng.next_u64()).source();
                    let clock_s = self.awg.nearest_s(seen.position(), seen.theta);
                    Some((Forecast::new(self.awg.clone(), source.ok()?), clock_s))
                })
                .collect();
            next.fill(usize::MAX);
            for step in (0..delays + lasting).rev() {
                let at = |(forecast, clock_s): &(Forecast, f64)| {
                    let position = forecast.at_time(clock_s + step as f64 * STEP_S);
                    Some(position.ok()?.point)
                };
                let positions: Vec<Point2<f64>> = match step {
                    0 => guards.iter().map(Pose2::position).collect(),
                    _ => forecasts.iter().filter_map(at).collect(),
                };
                let is_guarded = guarded(places, &positions, rule, &is_visible);
                for (place, next) in next.iter_mut().enumerate() {
                    if is_guarded[place] {
                        *next = step;
                    }
                    if step < delays && *next <= step + lasting {
                        detected[step * places.len() + place] += 1;
                    }
                }
            }
        }
        let (best, _) = detected
            .iter()
            .enumerate()
            .min_by_key(|(_, count)| **count)?;
        Some(Plan {
            place: best % places.len(),
            delay_s: (best / places.len()) as f64 * STEP_S,
        })
    }
}
