//! Means of measured values.

use core::f64::consts::FRAC_2_PI;

use geometry::math::{atan, cos, sin};

use super::interval::Interval;

/// Mean of independent values, with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    /// Number of values.
    pub count: usize,
    /// Mean.
    pub value: f64,
    /// Standard error of the mean; infinite for a single value.
    pub error: f64,
}

impl Mean {
    /// Computes the mean of values; `None` without values, or if one is not finite.
    pub fn from_values(values: &[f64]) -> Option<Self> {
        if values.is_empty() || !values.iter().all(|v| v.is_finite()) {
            return None;
        }
        let count = values.len();
        let n = count as f64;
        let value = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - value) * (v - value)).sum();
        let error = if count > 1 {
            (squares / (n - 1.0) / n).sqrt()
        } else {
            f64::INFINITY
        };
        Some(Self {
            count,
            value,
            error,
        })
    }

    /// Returns the 95 % confidence interval (Student's t); unbounded for a single value.
    pub fn interval(&self) -> Interval {
        let half = match self.count {
            0 | 1 => f64::INFINITY,
            n => student_95(n - 1) * self.error,
        };
        Interval {
            low: self.value - half,
            high: self.value + half,
        }
    }
}

/// Returns the two-sided 95 % quantile of Student's t with `freedom` degrees of freedom.
fn student_95(freedom: usize) -> f64 {
    // Above 2000 the quantile differs only in the fourth digit.
    let freedom = freedom.min(2000);
    let (mut low, mut high) = (0.0, 1000.0);
    loop {
        let middle = f64::midpoint(low, high);
        if middle <= low || middle >= high {
            return middle;
        }
        if within(middle, freedom) < 0.95 {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Returns the probability that Student's t lies within ±`t`.
///
/// Source: M. Abramowitz and I. Stegun, *Handbook of Mathematical Functions*, 26.7.3 and 26.7.4.
fn within(t: f64, freedom: usize) -> f64 {
    let theta = atan(t / (freedom as f64).sqrt());
    let (sine, cosine) = (sin(theta), cos(theta));
    let odd = freedom % 2 == 1;
    // Powers of the cosine in the terms: 1, 3, 5 … or 0, 2, 4 …, up to freedom − 2.
    let mut term = if odd { cosine } else { 1.0 };
    let mut power = usize::from(odd);
    let mut sum = 0.0;
    while power + 2 <= freedom {
        sum += term;
        term *= cosine * cosine * (power + 1) as f64 / (power + 2) as f64;
        power += 2;
    }
    if odd {
        FRAC_2_PI * (theta + sine * sum)
    } else {
        sine * sum
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (freedom, expected) in [
            (1, 12.706_204_7),
            (2, 4.302_652_7),
            (3, 3.182_446_3),
            (4, 2.776_445_1),
            (10, 2.228_138_9),
            (30, 2.042_272_5),
            (199, 1.971_956_5),
            (1_000_000, 1.961),
        ] {
            let t = student_95(freedom);
            let tolerance = if freedom > 2000 {
                1e-3
            } else {
                1e-6 * expected
            };
            assert!((t - expected).abs() < tolerance, "{freedom}: {t}");
        }
    }

    #[test]
    fn a_mean_has_the_expected_error() {
        let mean = Mean::from_values(&[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert_eq!((mean.count, mean.value), (4, 2.5));
        assert!((mean.error - 0.645_497_22).abs() < 1e-8);
        let interval = mean.interval();
        assert!((interval.high - 4.554_260_2).abs() < 1e-5, "{interval:?}");
        assert_eq!(Mean::from_values(&[]), None);
        assert_eq!(Mean::from_values(&[1.0, f64::NAN]), None);
        let one = Mean::from_values(&[7.0]).unwrap();
        assert!(one.interval().contains(-1e300));
    }

    proptest! {
        #[test]
        fn shifted_values_shift_the_interval(
            values in prop::collection::vec(-100.0_f64..100.0, 2..40), shift in -50.0_f64..50.0,
        ) {
            let moved: Vec<f64> = values.iter().map(|v| v + shift).collect();
            let (a, b) = (Mean::from_values(&values).unwrap(), Mean::from_values(&moved).unwrap());
            prop_assert!(a.interval().contains(a.value));
            prop_assert!((a.interval().low + shift - b.interval().low).abs() < 1e-9);
            prop_assert!((a.interval().width() - b.interval().width()).abs() < 1e-9);
        }
    }
}
