//! One watched robot: its looks, its goals, its predictors and their scores.

use nalgebra::Point2;

use crate::legs::Legs;
use crate::moment::{Look, Moment};
use crate::predictors::Predictor;
use crate::score::Score;
use tracking::space::Space;
use tracking::watch::Watch;

/// A predictor with its code and one score per time ahead.
struct Entry {
    method: u8,
    predictor: Box<dyn Predictor>,
    scores: Vec<Score>,
}

/// What one method says for one time ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MethodPrediction {
    /// Code of the method.
    pub method: u8,
    /// How far ahead (s).
    pub horizon: f64,
    /// Where the robot will be (m); `None` if the method cannot say.
    pub position: Option<Point2<f64>>,
    /// Error (m) of the last prediction for this time ahead that came due since the last report,
    /// infinite if none was made; `None` if none was due.
    pub error: Option<f64>,
    /// Goals made out.
    pub goals_observed: u32,
    /// Whether the key is known.
    pub key_recovered: bool,
}

/// Everything about one watched robot.
pub struct Watched {
    legs: Legs,
    entries: Vec<Entry>,
    /// Times ahead (s) and in ticks.
    horizons: Vec<(f64, u64)>,
    look: Option<Look>,
}

impl Watched {
    /// For a robot that turns to its next goal within `arrival` (m) of the last; `horizons` are in
    /// (s) and in ticks.
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

    /// Whether there is no predictor.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Takes up the look of a tick, with the truth that only scores see (m).
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
            // Asked in sight only: the question is lost on moments without goals.
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

    /// Predicts from the last look, which was at this tick, and reports; nothing before the first.
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
