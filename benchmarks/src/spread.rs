//! Medians and ratios.

use statistics::quantile;

/// Median and range of repeated measurements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// Minimum.
    pub min: f64,
    /// Maximum.
    pub max: f64,
}

impl Spread {
    /// Computes the spread of values; `None` without values. NaN counts as larger than every number.
    pub fn from_values(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let (&min, &max) = (sorted.first()?, sorted.last()?);
        Some(Self {
            median: quantile(&sorted, 0.5)?,
            min,
            max,
        })
    }
}

/// Returns the spread of the ratios `ours / baseline` of each pair.
///
/// The values of a pair are measured one after the other, so that other load on the machine affects both. The
/// median over pairs is robust against pairs in which it affects only one.
pub fn paired_ratio(ours: &[f64], baseline: &[f64]) -> Option<Spread> {
    Spread::from_values(
        ours.iter()
            .zip(baseline)
            .filter(|(_, b)| **b > 0.0)
            .map(|(a, b)| a / b),
    )
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_median_of_an_even_number_lies_between_the_middle_two() {
        let spread = Spread::from_values([4.0, 1.0, 3.0, 2.0]).unwrap();
        assert_eq!((spread.min, spread.median, spread.max), (1.0, 2.5, 4.0));
        assert_eq!(Spread::from_values([7.0]).unwrap().median, 7.0);
        assert_eq!(Spread::from_values([]), None);
    }

    #[test]
    fn ratios_are_taken_pair_by_pair() {
        // The machine was ten times slower during the second pair, which does not change its ratio.
        let ratio = paired_ratio(&[80.0, 8.0, 90.0], &[100.0, 10.0, 100.0]).unwrap();
        assert!((ratio.median - 0.8).abs() < 1e-12 && (ratio.max - 0.9).abs() < 1e-12);
        assert_eq!(paired_ratio(&[1.0], &[0.0]), None, "no baseline, no ratio");
    }

    proptest! {
        #[test]
        fn the_median_has_as_many_below_as_above(values in prop::collection::vec(-1e9..1e9, 1..50)) {
            let spread = Spread::from_values(values.iter().copied()).unwrap();
            let below = values.iter().filter(|v| **v < spread.median).count();
            let above = values.iter().filter(|v| **v > spread.median).count();
            prop_assert!(below <= values.len() / 2 && above <= values.len() / 2);
            prop_assert!(spread.min <= spread.median && spread.median <= spread.max);
        }
    }
}
