//! Families of comparisons with a common error rate.

use statistics::{Interval, Sample};

use super::MARGIN;
use crate::statistics::{Difference, holm, simultaneous_z};
use crate::words::{p_value, point_range, points};

/// Result of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    Higher,
    Lower,
    /// Not lower by more than [`MARGIN`], but not significantly higher.
    NotLower,
    Open,
}

impl Order {
    fn word(self) -> &'static str {
        match self {
            Self::Higher => "higher",
            Self::Lower => "lower",
            Self::NotLower => "not lower",
            Self::Open => "open",
        }
    }
}

/// One of several comparisons.
#[derive(Debug, Clone)]
pub(super) struct Comparison {
    label: String,
    value: f64,
    interval: Interval,
    p_value: f64,
    pub(super) order: Order,
}

impl Comparison {
    /// Describes it: `RRT* less potential field at 1.5×: +40.0 points (+31.2 … +48.1), p < 0.0001:
    /// higher`.
    pub(super) fn words(&self) -> String {
        format!(
            "{}: {} points ({}), {}: {}",
            self.label,
            points(self.value),
            point_range(self.interval),
            p_value(self.p_value),
            self.order.word()
        )
    }
}

/// Compares the first with the second of every pair, with Holm's p-values and simultaneous
/// intervals. `None` if a sample is empty.
pub(super) fn family(pairs: &[(String, Sample, Sample)]) -> Option<Vec<Comparison>> {
    let differences: Option<Vec<Difference>> =
        pairs.iter().map(|p| Difference::of(&p.1, &p.2)).collect();
    let differences = differences?;
    let raw: Vec<f64> = differences.iter().map(|d| d.p_value).collect();
    let z = simultaneous_z(pairs.len());
    let found = pairs
        .iter()
        .zip(&differences)
        .zip(holm(&raw))
        .map(|((pair, d), p)| {
            let interval = d.interval(z);
            let order = match (p < 0.05, d.value > 0.0) {
                (true, true) => Order::Higher,
                (true, false) => Order::Lower,
                _ if interval.low >= -MARGIN => Order::NotLower,
                _ => Order::Open,
            };
            Comparison {
                label: pair.0.clone(),
                value: d.value,
                interval,
                p_value: p,
                order,
            }
        });
    Some(found.collect())
}
