//! Watched robot: its observations, goals, predictors and their scores.

use nalgebra::Point2;

use crate::legs::Legs;
use crate::moment::{Look, Moment};
use crate::predictors::Predictor;
use crate::score::Score;
use tracking::space::Space;
use tracking::watch::Watch;

/// Predictor with its code and one score per horizon.
struct Entry {
    method: u8,
    predictor: Box<dyn Predictor>,
    scores: Vec<Score>,
}

/// Prediction of one method for one horizon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MethodPrediction {
    /// Code of the method.
    pub method: u8,
    /// Horizon (s).
    pub horizon: f64,
    /// Predicted position (m); `None` if the method has no prediction.
    pub position: Option<Point2<f64>>,
    /// Error (m) of the last prediction for this horizon that has become due since the last report,
    /// infinite if there was none; `None` if none was due.
    pub error: Option<f64>,
    /// Number of detected goals.
    pub goals_observed: u32,
    /// `true` if the key is known.
    pub key_recovered: bool,
}

/// State of one watched robot.
pub struct WatchedRobot {
    legs: Legs,
    entries: Vec<Entry>,
    /// Horizons (s) and in ticks.
    horizons: Vec<(f64, u64)>,
    look: Option<Look>,
}

impl WatchedRobot {
    /// Returns the state of a robot that turns to its next goal within `arrival` (m) of the last;
    /// `horizons` are in (s) and in ticks.
    pub fn new(arrival: f64, horizons: Vec<(f64, u64)>) -> Self {
        Self {
            legs: Legs::new(arrival),
            entries: Vec::new(),
            horizons,
            look: None,
        }
    }

    /// Adds a predictor with its code.
    pub fn add(&mut self, method: u8, predictor: impl Predictor + 'static) {
        self.entries.push(Entry {
            method,
            predictor: Box::new(predictor),
            scores: vec![Score::default(); self.horizons.len()],
        });
    }

    /// Predictions per report.
    pub fn len(&self) -> usize {
        self.entries.len() * self.horizons.len()
    }

    /// Returns `true` if there is no predictor.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Processes the observation of a tick, with the true position for the scores alone (m).
    pub fn observe(
        &mut self,
        tick: u64,
        look: Look,
        truth: Point2<f64>,
        (space, watch): (&Space, &Watch),
    ) {
        let goal = self.legs.observe(&look);
        let moment = Moment {
            look,
            goal,
            // Called in sight only: moments without goals discard the flag.
            goals_lost: look.seen.is_some() && self.legs.take_lost(),
            space,
            watch,
        };
        for entry in &mut self.entries {
            entry.predictor.observe(&moment);
            for score in &mut entry.scores {
                score.compare(tick, truth);
            }
        }
        self.look = Some(look);
    }

    /// Predicts from the last observation, which was at this tick, and reports; nothing before the
    /// first.
    pub fn report(
        &mut self,
        tick: u64,
        (space, watch): (&Space, &Watch),
        mut with: impl FnMut(MethodPrediction),
    ) {
        let Some(look) = self.look else { return };
        let moment = Moment {
            look,
            goal: None,
            goals_lost: false,
            space,
            watch,
        };
        for entry in &mut self.entries {
            let predictor = &entry.predictor;
            for (&(horizon, ticks), score) in self.horizons.iter().zip(&mut entry.scores) {
                let position = predictor
                    .predict(horizon, &moment)
                    .filter(|p| p.x.is_finite() && p.y.is_finite());
                with(MethodPrediction {
                    method: entry.method,
                    horizon,
                    position,
                    error: score.take(),
                    goals_observed: predictor.goals_observed(),
                    key_recovered: predictor.key_recovered(),
                });
                score.keep(tick.saturating_add(ticks), position);
            }
        }
    }
}
