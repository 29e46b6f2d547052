//! Comparison of two samples.

use statistics::{Interval, Sample, wilson_at};

use super::newcombe::newcombe;
use super::normal::two_sided;

/// The difference of the shares of two samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Share of the first less share of the second, −1 to 1.
    pub value: f64,
    /// Its standard error (score form: under the hypothesis that there is no difference).
    pub error: f64,
    /// Two-sided p-value of the hypothesis that there is no difference.
    pub p_value: f64,
    first: (f64, f64),
    second: (f64, f64),
}

impl Difference {
    /// Compares two independent samples; `None` if one of them is empty.
    ///
    /// The test is the score test of two proportions, with the outcomes of each sample counted by
    /// their [effective size](Sample::effective_size).
    pub fn of(first: &Sample, second: &Sample) -> Option<Self> {
        let (p, q) = (first.share()?, second.share()?);
        let (n, m) = (first.effective_size(), second.effective_size());
        let pooled = (p * n + q * m) / (n + m);
        let error = (pooled * (1.0 - pooled) * (1.0 / n + 1.0 / m))
            .max(0.0)
            .sqrt();
        let value = p - q;
        // All or none in both samples: no difference, and no standard error.
        let p_value = if error > 0.0 {
            two_sided(value / error)
        } else {
            1.0
        };
        Some(Self {
            value,
            error,
            p_value,
            first: (p, n),
            second: (q, m),
        })
    }

    /// Returns the interval of the difference, `z` standard errors to either side (Newcombe's).
    pub fn interval(&self, z: f64) -> Interval {
        let part = |(share, n): (f64, f64)| (share, wilson_at(share, n, z));
        newcombe(part(self.first), part(self.second))
    }
}

/// Returns the first difference less the second, with its interval, `z` standard errors to either
/// side, by the rule of [`newcombe`] from the intervals of both. The differences are of four
/// independent samples.
pub fn difference_of_differences(
    first: &Difference,
    second: &Difference,
    z: f64,
) -> (f64, Interval) {
    let (a, b) = (first.interval(z), second.interval(z));
    let square = |v: f64| v * v;
    let value = first.value - second.value;
    let down = (square(first.value - a.low) + square(b.high - second.value)).sqrt();
    let up = (square(a.high - first.value) + square(second.value - b.low)).sqrt();
    let interval = Interval {
        low: (value - down).max(-2.0),
        high: (value + up).min(2.0),
    };
    (value, interval)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use statistics::Z95;

    use super::*;

    fn singles(hits: u32, of: u32) -> Sample {
        (0..of).map(|i| (u32::from(i < hits), 1)).collect()
    }

    #[test]
    fn independent_outcomes_give_the_textbook_test() {
        // 120 of 400 against 160 of 400: z = 0.1 / √(0.35 · 0.65 · 2/400) = 2.965.
        let d = Difference::of(&singles(160, 400), &singles(120, 400)).unwrap();
        assert!((d.value - 0.1).abs() < 1e-12);
        // The effective size is n − 1 here: the variance between groups is an estimate.
        assert!((d.value / d.error - 2.965).abs() < 0.01, "{d:?}");
        assert!((d.p_value - 0.003).abs() < 0.0003, "{d:?}");
        let interval = d.interval(Z95);
        assert!(interval.low > 0.0 && interval.contains(0.1));
    }

    #[test]
    fn dependent_outcomes_have_a_smaller_effective_size() {
        let pairs = |hits: u32| (0..200).map(move |i| if i < hits { (2, 2) } else { (0, 2) });
        let twins = Difference::of(&pairs(80).collect(), &pairs(60).collect()).unwrap();
        let free = Difference::of(&singles(160, 400), &singles(120, 400)).unwrap();
        assert_eq!(twins.value, free.value);
        assert!(twins.p_value > 5.0 * free.p_value);
    }

    #[test]
    fn equal_extremes_do_not_differ() {
        let d = Difference::of(&singles(0, 50), &singles(0, 80)).unwrap();
        assert_eq!((d.value, d.p_value), (0.0, 1.0));
        assert!(d.interval(Z95).contains(0.0) && d.interval(Z95).width() > 0.05);
        assert_eq!(Difference::of(&singles(0, 0), &singles(1, 2)), None);
    }

    proptest! {
        #[test]
        fn the_difference_is_antisymmetric(n in 1_u32..80, m in 1_u32..80, i in 0_u32..80, j in 0_u32..80) {
            let (a, b) = (singles(i.min(n), n), singles(j.min(m), m));
            let (ab, ba) = (Difference::of(&a, &b).unwrap(), Difference::of(&b, &a).unwrap());
            prop_assert!((ab.value + ba.value).abs() < 1e-12);
            prop_assert!((ab.p_value - ba.p_value).abs() < 1e-12);
            prop_assert!(ab.interval(Z95).contains(ab.value));
            let (twice, interval) = difference_of_differences(&ab, &ba, Z95);
            prop_assert!((twice - 2.0 * ab.value).abs() < 1e-12 && interval.contains(twice));
        }
    }
}
