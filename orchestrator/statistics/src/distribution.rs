//! Distributions of times: histograms with three significant digits, in constant memory.

use std::collections::BTreeMap;

use hdrhistogram::Histogram;
use serde::{Deserialize, Serialize};

/// Maximum time of the histogram (ns); longer times count as this one.
const MAX_TIME_NS: u64 = 3_600_000_000_000;

/// Percentiles of a measured time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Percentiles {
    /// Number of measurements.
    pub count: u64,
    /// Median (µs).
    pub p50: f64,
    /// 90th percentile (µs).
    pub p90: f64,
    /// 99th percentile (µs).
    pub p99: f64,
    /// 99.9th percentile (µs); 0 in results of versions without it.
    #[serde(default)]
    pub p999: f64,
    /// Maximum (µs).
    pub max: f64,
    /// Jitter (µs): mean of |difference to the previous measurement|; 0 in results of versions without it.
    #[serde(default)]
    pub jitter: f64,
}

/// Histogram on a logarithmic axis.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct LogHistogram {
    /// Index of the first bin: it begins at 10^(`first` / bins per decade) (ns).
    pub first: u32,
    /// Counts by bin.
    pub counts: Vec<u64>,
}

/// Distribution of measured times.
#[derive(Debug, Clone)]
pub struct Distribution {
    histogram: Histogram<u64>,
    /// Exact, unlike the histogram.
    max: u64,
    last: Option<u64>,
    /// Sum of all |differences to the previous measurement|.
    moved: u64,
}

impl Distribution {
    /// Returns an empty distribution; never `None`, because the bounds are constant and valid.
    pub fn new() -> Option<Self> {
        // Three digits from 1 ns; grows with the recorded values, up to an hour.
        let mut histogram = Histogram::new_with_bounds(1, 60_000_000_000, 3).ok()?;
        histogram.auto(true);
        Some(Self {
            histogram,
            max: 0,
            last: None,
            moved: 0,
        })
    }

    /// Records a measurement (ns).
    pub fn record(&mut self, ns: u64) {
        // Cannot fail: the histogram grows, and the value is at most the maximum.
        let _ = self.histogram.record(ns.min(MAX_TIME_NS));
        self.max = self.max.max(ns);
        if let Some(last) = self.last.replace(ns) {
            self.moved = self.moved.saturating_add(last.abs_diff(ns));
        }
    }

    /// Returns the number of measurements.
    pub fn count(&self) -> u64 {
        self.histogram.len()
    }

    /// Returns the quantile for a share of the measurements (µs).
    pub fn at(&self, share: f64) -> f64 {
        microseconds(self.histogram.value_at_quantile(share).min(self.max))
    }

    /// Returns the percentiles.
    pub fn percentiles(&self) -> Percentiles {
        let pairs = self.count().saturating_sub(1).max(1);
        Percentiles {
            count: self.count(),
            p50: self.at(0.5),
            p90: self.at(0.9),
            p99: self.at(0.99),
            p999: self.at(0.999),
            max: microseconds(self.max),
            jitter: microseconds(self.moved) / pairs as f64,
        }
    }

    /// Returns a histogram with `per_decade` bins of equal width on a logarithmic axis, from the first to the
    /// last bin that is not empty.
    pub fn log_histogram(&self, per_decade: u32) -> LogHistogram {
        let part = |ns: u64| {
            let decades = geometry::math::ln(ns.max(1) as f64) / core::f64::consts::LN_10;
            (decades * f64::from(per_decade)).floor() as u32
        };
        let mut counts: BTreeMap<u32, u64> = BTreeMap::new();
        for value in self.histogram.iter_recorded() {
            let at = part(value.value_iterated_to());
            *counts.entry(at).or_insert(0) += value.count_since_last_iteration();
        }
        let first = counts.keys().next().copied().unwrap_or(0);
        let last = counts.keys().next_back().copied().unwrap_or(0);
        let counts = (first..=last)
            .map(|part| counts.get(&part).copied().unwrap_or(0))
            .collect();
        LogHistogram { first, counts }
    }
}

/// Distributions by name.
#[derive(Debug, Clone, Default)]
pub struct Distributions(BTreeMap<String, Distribution>);

impl Distributions {
    /// Records a measurement (ns) in the distribution with this name.
    pub fn record(&mut self, name: &str, ns: u64) {
        if let Some(known) = self.0.get_mut(name) {
            known.record(ns);
        } else if let Some(mut new) = Distribution::new() {
            new.record(ns);
            self.0.insert(name.to_owned(), new);
        }
    }

    /// Returns all distributions, by name.
    pub fn iter(&self) -> impl Iterator<Item = (&String, &Distribution)> {
        self.0.iter()
    }

    /// Returns the distribution with this name.
    pub fn get(&self, name: &str) -> Option<&Distribution> {
        self.0.get(name)
    }
}

/// Converts nanoseconds to microseconds; exact below 2^53 ns.
fn microseconds(ns: u64) -> f64 {
    ns as f64 / 1e3
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn of(values: &[u64]) -> Distribution {
        let mut distribution = Distribution::new().unwrap();
        for ns in values {
            distribution.record(*ns);
        }
        distribution
    }

    #[test]
    fn jitter_is_the_mean_step_from_one_to_the_next() {
        assert_eq!(of(&[1_000, 3_000, 2_000]).percentiles().jitter, 1.5);
        assert_eq!(of(&[5_000; 4]).percentiles().jitter, 0.0);
        assert_eq!(of(&[5_000]).percentiles().jitter, 0.0);
        assert_eq!(of(&[]).percentiles(), Percentiles::default());
    }

    #[test]
    fn figures_missing_in_older_results_are_zero() {
        let text = r#"{"count":1,"p50":1.0,"p90":1.0,"p99":1.0,"max":1.0}"#;
        let percentiles: Percentiles = serde_json::from_str(text).unwrap();
        assert_eq!((percentiles.p999, percentiles.jitter), (0.0, 0.0));
    }

    #[test]
    fn times_above_the_maximum_count_as_the_maximum() {
        let far = of(&[u64::MAX, 1]);
        assert_eq!(far.count(), 2);
        assert!(far.at(0.9) >= 3.5e9);
    }

    proptest! {
        #[test]
        fn percentiles_are_ordered_and_near_the_ranks(
            mut values in prop::collection::vec(1_u64..10_000_000_000, 1..200)
        ) {
            let distribution = of(&values);
            let p = distribution.percentiles();
            prop_assert!([p.p50, p.p90, p.p99, p.p999, p.max].is_sorted());
            values.sort_unstable();
            for share in [0.5, 0.9, 0.99] {
                let rank = (share * values.len() as f64).ceil() as usize;
                let exact = values[rank.max(1) - 1] as f64 / 1e3;
                prop_assert!((distribution.at(share) - exact).abs() <= 2e-3 * exact + 1e-3);
            }
            let histogram = distribution.log_histogram(8);
            prop_assert_eq!(histogram.counts.iter().sum::<u64>(), values.len() as u64);
        }
    }
}
