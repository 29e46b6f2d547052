//! Comparison of predictions with the truth when they are due.

use std::collections::VecDeque;

use nalgebra::Point2;

/// Predictions of one method for one horizon.
#[derive(Debug, Clone, Default)]
pub struct Score {
    /// Tick at which a prediction is due, and the prediction.
    pending: VecDeque<(u64, Option<Point2<f64>>)>,
    /// Error of the last one that has become due since the last call.
    last: Option<f64>,
}

impl Score {
    /// Stores a prediction for a tick, later than those of the predictions before; `None` if the
    /// method had none.
    pub fn keep(&mut self, due: u64, prediction: Option<Point2<f64>>) {
        self.pending.push_back((due, prediction));
    }

    /// Compares the due predictions with the true position at a tick (m).
    pub fn compare(&mut self, tick: u64, truth: Point2<f64>) {
        while let Some(&(due, prediction)) = self.pending.front()
            && due <= tick
        {
            self.pending.pop_front();
            // Where ticks were missed, the true position at the time is not known.
            if due == tick {
                self.last = Some(prediction.map_or(f64::INFINITY, |point| (point - truth).norm()));
            }
        }
    }

    /// Returns the error (m) of the last prediction that has become due since the last call;
    /// infinite if the method had none. `None` if none was due.
    pub fn take(&mut self) -> Option<f64> {
        self.last.take()
    }

    /// Drops all predictions.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_prediction_is_scored_at_its_tick_and_only_then() {
        let mut score = Score::default();
        score.keep(3, Some(Point2::new(3.0, 4.0)));
        score.keep(5, None);
        score.keep(7, Some(Point2::origin()));
        score.compare(2, Point2::origin());
        assert_eq!(score.take(), None);
        score.compare(3, Point2::origin());
        assert_eq!(score.take(), Some(5.0));
        assert_eq!(score.take(), None);
        score.compare(5, Point2::origin());
        assert_eq!(score.take(), Some(f64::INFINITY));
        // Tick 7 was missed.
        score.compare(8, Point2::origin());
        assert_eq!(score.take(), None);
    }
}
