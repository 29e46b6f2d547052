//! Prediction that the goal after the most similar goal of the past follows again.

use metrics::prediction::{NearestNeighbour, View};
use nalgebra::Point2;

use super::Predictor;
use crate::moment::Moment;
use crate::travel::{Pace, along};

/// Maximum number of goals predicted ahead.
const MAX_GOALS: usize = 64;

/// Nearest neighbour in the history of goals, and the path through the predicted goals.
#[derive(Debug, Clone)]
pub struct SimilarGoal {
    neighbour: NearestNeighbour,
    pace: Pace,
}

impl SimilarGoal {
    /// Returns a predictor that compares both coordinates of a goal together or separately.
    pub fn new(view: View) -> Self {
        Self {
            neighbour: NearestNeighbour::new(view),
            pace: Pace::default(),
        }
    }
}

impl Predictor for SimilarGoal {
    fn observe(&mut self, moment: &Moment<'_>) {
        self.pace.observe(moment);
        if let Some(goal) = moment.goal {
            self.neighbour.observe(goal.point);
        }
    }

    fn predict(&self, horizon: f64, _: &Moment<'_>) -> Option<Point2<f64>> {
        let (from, length) = self.pace.way(horizon)?;
        let mut goals = Vec::new();
        let (mut way, mut at) = (0.0, from);
        let mut next = self.neighbour.predict();
        while let Some(goal) = next
            && way < length
            && goals.len() < MAX_GOALS
        {
            way += (goal - at).norm();
            at = goal;
            goals.push(goal);
            next = self.neighbour.after(goal);
        }
        along(from, goals, length)
    }

    fn goals_observed(&self) -> u32 {
        u32::try_from(self.neighbour.len()).unwrap_or(u32::MAX)
    }
}
