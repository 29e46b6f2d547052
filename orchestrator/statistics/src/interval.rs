//! A closed interval.

use serde::{Deserialize, Serialize};

/// A closed interval; `low` ≤ `high`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
}

impl Interval {
    /// The interval of all shares, for a share without data.
    pub const UNIT: Self = Self {
        low: 0.0,
        high: 1.0,
    };

    /// Returns `true` if the interval contains the value.
    pub fn contains(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// Returns the width of the interval.
    pub fn width(&self) -> f64 {
        self.high - self.low
    }
}
