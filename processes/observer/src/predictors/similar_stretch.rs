//! Prediction that a robot repeats its motion after the most similar stretch of its past.

use nalgebra::Point2;

use super::Predictor;
use crate::moment::Moment;

/// Maximum number of samples; the oldest are dropped.
pub const MAX_SAMPLES: usize = 50_000;

/// Nearest neighbour in the history of positions: the past stretch that is nearest to the last one,
/// point by point, and the displacement after it.
#[derive(Debug, Clone)]
pub struct SimilarStretch {
    /// Time between two samples (s).
    step: f64,
    /// Samples of a stretch.
    length: usize,
    /// One position per step, `None` out of sight.
    samples: Vec<Option<Point2<f64>>>,
    /// Time at which the next sample is due (s).
    due: Option<f64>,
    /// Time since the last sample (s).
    since: f64,
}

impl SimilarStretch {
    /// Returns a predictor that compares stretches of `stretch` (s), sampled every `step` (s); both
    /// > 0.
    pub fn new(stretch: f64, step: f64) -> Self {
        Self {
            step,
            // A cast of a float saturates.
            length: ((stretch / step).round() as usize).max(1) + 1,
            samples: Vec::new(),
            due: None,
            since: 0.0,
        }
    }

    /// Returns the robot's position this many samples after a sample, linear between samples (m).
    fn after(&self, sample: usize, steps: f64) -> Option<Point2<f64>> {
        let at = |index: usize| self.samples.get(index).copied().flatten();
        let before = at(sample + steps.floor() as usize)?;
        let part = steps - steps.floor();
        if part == 0.0 {
            return Some(before);
        }
        let next = at(sample + steps.ceil() as usize)?;
        Some(before + (next - before) * part)
    }

    /// Returns the past stretch most similar to the last one, ended at least `ahead` samples ago:
    /// index of its last sample.
    fn most_similar(&self, ahead: usize) -> Option<usize> {
        let n = self.samples.len();
        let present = self.samples.get(n.checked_sub(self.length)?..)?;
        let mut best: Option<(f64, usize)> = None;
        for (first, past) in self.samples.windows(self.length).enumerate() {
            let last = first + self.length - 1;
            if last + ahead >= n {
                break;
            }
            // The continuation must have been observed.
            if self.samples.get(last + ahead).copied().flatten().is_none() {
                continue;
            }
            let least = best.map_or(f64::INFINITY, |(least, _)| least);
            if let Some(d) = distance(past, present, least)
                && d < least
            {
                best = Some((d, last));
            }
        }
        best.map(|(_, last)| last)
    }
}

/// Returns the sum of the squared distances, point by point; `None` if a point is missing or the
/// sum exceeds `bound`.
fn distance(a: &[Option<Point2<f64>>], b: &[Option<Point2<f64>>], bound: f64) -> Option<f64> {
    let mut sum = 0.0;
    for (a, b) in a.iter().zip(b) {
        sum += ((*a)? - (*b)?).norm_squared();
        if sum > bound {
            return None;
        }
    }
    Some(sum)
}

impl Predictor for SimilarStretch {
    fn observe(&mut self, moment: &Moment<'_>) {
        let look = &moment.look;
        // Tolerance of half an observation period: the times are sums of rounded steps.
        let due = *self.due.get_or_insert(look.time);
        if look.time + 0.5 * look.dt < due {
            self.since += look.dt;
            return;
        }
        self.since = 0.0;
        self.due = Some(due.max(look.time - self.step) + self.step);
        if self.samples.len() == MAX_SAMPLES {
            self.samples.drain(..MAX_SAMPLES / 10);
        }
        self.samples.push(look.seen.map(|seen| seen.position));
    }

    fn predict(&self, horizon: f64, moment: &Moment<'_>) -> Option<Point2<f64>> {
        let now = moment.look.seen?.position;
        let (from, to) = (self.since / self.step, (self.since + horizon) / self.step);
        let last = self.most_similar(to.ceil() as usize)?;
        Some(now + (self.after(last, to)? - self.after(last, from)?))
    }
}
