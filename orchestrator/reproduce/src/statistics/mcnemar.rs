//! McNemar's exact test.

use core::f64::consts::LN_2;

use geometry::math::exp;

use super::fisher::ln_choose;

/// Returns the two-sided p-value of the hypothesis that pairs which differ favour either side with the same
/// chance: `first` pairs favour the first side, `second` the other. Pairs that do not differ do not count.
///
/// 1 if no pair differs.
///
/// Source: Q. McNemar, *Note on the sampling error of the difference between correlated proportions or
/// percentages*, Psychometrika 12 (1947); exact by the binomial distribution (sign test).
pub fn mcnemar_exact(first: u64, second: u64) -> f64 {
    let n = first + second;
    let fewer = first.min(second);
    let ln_all = n as f64 * LN_2;
    let tail: f64 = (0..=fewer).map(|k| exp(ln_choose(n, k) - ln_all)).sum();
    (2.0 * tail).min(1.0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn p_values_are_those_of_a_fair_coin() {
        // By hand: 2 · (1 + 10) / 2¹⁰, 2 / 2⁵, 2 · (1 + 14 + 91) / 2¹⁴.
        for (first, second, expected) in [
            (1, 9, 22.0 / 1024.0),
            (0, 5, 2.0 / 32.0),
            (12, 2, 212.0 / 16384.0),
            (3, 3, 1.0),
            (0, 0, 1.0),
            (1, 0, 1.0),
        ] {
            let p = mcnemar_exact(first, second);
            assert!((p - expected).abs() < 1e-12, "{first} {second}: {p}");
        }
    }

    proptest! {
        #[test]
        fn the_test_is_symmetric_and_a_probability(a in 0_u64..400, b in 0_u64..400) {
            let p = mcnemar_exact(a, b);
            prop_assert!(p > 0.0 && p <= 1.0);
            prop_assert_eq!(p, mcnemar_exact(b, a));
        }
    }
}
