//! Statistics of prediction errors.

use crate::quantile::quantile;

/// Statistics of errors. All values are in the unit of the errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorStatistics {
    /// Number of finite errors; the others count as missing predictions.
    pub count: usize,
    /// Number of missing predictions.
    pub missing: usize,
    /// Mean.
    pub mean: f64,
    /// Median.
    pub median: f64,
    /// Root mean square.
    pub rms: f64,
    /// 10 % quantile.
    pub q10: f64,
    /// 90 % quantile.
    pub q90: f64,
    /// Maximum.
    pub max: f64,
}

impl ErrorStatistics {
    /// Computes the statistics of errors in any order; `None` without a finite one.
    pub fn from_errors(errors: &[f64]) -> Option<Self> {
        let mut finite: Vec<f64> = errors.iter().copied().filter(|e| e.is_finite()).collect();
        // Sorted first: the sums do not depend on the order of the errors.
        finite.sort_unstable_by(f64::total_cmp);
        let n = finite.len() as f64;
        let max = *finite.last()?;
        Some(Self {
            count: finite.len(),
            missing: errors.len() - finite.len(),
            mean: finite.iter().sum::<f64>() / n,
            median: quantile(&finite, 0.5)?,
            rms: (finite.iter().map(|e| e * e).sum::<f64>() / n).sqrt(),
            q10: quantile(&finite, 0.1)?,
            q90: quantile(&finite, 0.9)?,
            max,
        })
    }
}

/// Errors of predictions for several horizons.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorsByHorizon {
    horizons: Vec<f64>,
    errors: Vec<Vec<f64>>,
}

impl ErrorsByHorizon {
    /// Creates empty statistics for these horizons (s).
    pub fn new(horizons: &[f64]) -> Self {
        Self {
            horizons: horizons.to_vec(),
            errors: vec![Vec::new(); horizons.len()],
        }
    }

    /// Adds the error (m) of a prediction for the horizon with this index; an error that is not
    /// finite counts as a missing prediction. An unknown index is ignored.
    pub fn add(&mut self, horizon: usize, error: f64) {
        if let Some(errors) = self.errors.get_mut(horizon) {
            errors.push(error);
        }
    }

    /// Every horizon (s) with its statistics, `None` without predictions.
    pub fn statistics(&self) -> impl Iterator<Item = (f64, Option<ErrorStatistics>)> + '_ {
        let statistics = self.errors.iter().map(|e| ErrorStatistics::from_errors(e));
        self.horizons.iter().copied().zip(statistics)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn known_errors_have_known_statistics() {
        let s = ErrorStatistics::from_errors(&[4.0, 0.0, f64::INFINITY, 3.0, 1.0, 2.0]).unwrap();
        assert_eq!((s.count, s.missing), (5, 1));
        assert_eq!((s.mean, s.median, s.max), (2.0, 2.0, 4.0));
        assert_eq!(s.rms, 6.0_f64.sqrt());
        assert!((s.q10 - 0.4).abs() < 1e-12 && (s.q90 - 3.6).abs() < 1e-12);
        assert_eq!(ErrorStatistics::from_errors(&[f64::NAN]), None);
    }

    #[test]
    fn horizons_are_kept_apart() {
        let mut errors = ErrorsByHorizon::new(&[0.5, 2.0, 5.0]);
        for (horizon, error) in [(0, 1.0), (1, 5.0), (0, 3.0), (1, f64::INFINITY), (9, 1.0)] {
            errors.add(horizon, error);
        }
        let found: Vec<_> = errors
            .statistics()
            .map(|(horizon, s)| (horizon, s.map(|s| (s.mean, s.count, s.missing))))
            .collect();
        assert_eq!(
            found,
            [
                (0.5, Some((2.0, 2, 0))),
                (2.0, Some((5.0, 1, 1))),
                (5.0, None)
            ]
        );
    }

    proptest! {
        #[test]
        fn statistics_are_ordered_and_do_not_depend_on_the_order(
            mut errors in prop::collection::vec(0.0..1e3_f64, 1..40),
        ) {
            let s = ErrorStatistics::from_errors(&errors).unwrap();
            prop_assert!(s.q10 <= s.median && s.median <= s.q90 && s.q90 <= s.max);
            prop_assert!(s.mean <= s.rms * (1.0 + 1e-12));
            errors.reverse();
            prop_assert_eq!(ErrorStatistics::from_errors(&errors).unwrap(), s);
        }
    }
}
