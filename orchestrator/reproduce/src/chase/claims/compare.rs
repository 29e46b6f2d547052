//! Families of comparisons with a common error rate.

use statistics::Interval;

use super::MARGIN;
use crate::claim::{Measured, Unit};
use crate::statistics::{BySeed, Difference, holm, simultaneous_z};
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
    difference: Difference,
    interval: Interval,
    p_value: f64,
    /// Number of seeds that both cells have.
    games: u64,
    pub(super) order: Order,
}

impl Comparison {
    /// Describes it: `RRT* less potential field at 1.5×: +40.0 points (+31.2 … +48.1), more in 70 games, fewer
    /// in 9, p < 0.0001: higher`.
    pub(super) fn words(&self) -> String {
        let [more, fewer] = self.difference.larger;
        format!(
            "{}: {} points ({}), more in {more} games, fewer in {fewer}, {}: {}",
            self.label,
            points(self.difference.value),
            point_range(self.interval),
            p_value(self.p_value),
            self.order.word()
        )
    }
}

/// Returns the comparison with the smallest difference, as the number that a claim rests on.
pub(super) fn least(comparisons: &[Comparison]) -> Measured {
    let by_value =
        |a: &&Comparison, b: &&Comparison| a.difference.value.total_cmp(&b.difference.value);
    let Some(found) = comparisons.iter().min_by(by_value) else {
        return Measured::none();
    };
    let games = (found.games, "games");
    let mut ours = Measured::number(found.difference.value, found.interval, Unit::Points, games);
    if comparisons.len() > 1 {
        ours.text += &format!(", the least of {}", comparisons.len());
    }
    ours
}

/// Compares the first with the second of every pair, with Holm's p-values and simultaneous
/// intervals. `None` if a pair has no common seed.
pub(super) fn family(pairs: &[(String, &BySeed, &BySeed)]) -> Option<Vec<Comparison>> {
    let differences: Option<Vec<Difference>> =
        pairs.iter().map(|p| Difference::of(p.1, p.2)).collect();
    let differences = differences?;
    let raw: Vec<f64> = differences.iter().map(|d| d.p_value).collect();
    let z = simultaneous_z(pairs.len());
    let found = pairs
        .iter()
        .zip(differences)
        .zip(holm(&raw))
        .map(|((pair, d), p)| {
            let interval = d.interval(z);
            let [more, fewer] = d.larger;
            // The test counts games, the interval counts evaders.
            let order = match (p < 0.05 && (more > fewer) == (d.value > 0.0), d.value > 0.0) {
                (true, true) => Order::Higher,
                (true, false) => Order::Lower,
                _ if interval.low >= -MARGIN => Order::NotLower,
                _ => Order::Open,
            };
            Comparison {
                label: pair.0.clone(),
                difference: d,
                interval,
                p_value: p,
                games: pair
                    .1
                    .keys()
                    .filter(|seed| pair.2.contains_key(seed))
                    .count() as u64,
                order,
            }
        });
    Some(found.collect())
}
