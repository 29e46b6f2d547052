//! Fisher's exact test.

use geometry::math::{exp, ln_gamma};

/// Returns the two-sided p-value of the hypothesis that `a` hits of `n` and `b` hits of `m`
/// independent outcomes have the same chance: the probability, given the total of hits, of all
/// divisions that are at most as probable as this one.
///
/// 1 if one of the samples is empty; more hits than outcomes count as all outcomes.
///
/// Source: R. A. Fisher, *Statistical Methods for Research Workers*, §21.02; two-sided by summing
/// the improbable tables, as R and SciPy do.
pub fn fisher_exact((a, n): (u64, u64), (b, m): (u64, u64)) -> f64 {
    let (a, b) = (a.min(n), b.min(m));
    if n == 0 || m == 0 {
        return 1.0;
    }
    let hits = a + b;
    let all = ln_choose(n + m, hits);
    let ln_chance = |k: u64| ln_choose(n, k) + ln_choose(m, hits - k) - all;
    // Chances that differ by rounding only are equal.
    let limit = ln_chance(a) + 1e-7;
    let sum: f64 = (hits.saturating_sub(m)..=hits.min(n))
        .map(ln_chance)
        .filter(|&l| l <= limit)
        .map(exp)
        .sum();
    sum.min(1.0)
}

/// Returns the logarithm of the number of ways to choose `k` of `n`; `k` ≤ `n`.
pub(super) fn ln_choose(n: u64, k: u64) -> f64 {
    let ln_factorial = |v: u64| ln_gamma(v as f64 + 1.0);
    ln_factorial(n) - ln_factorial(k) - ln_factorial(n - k)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn p_values_of_the_paper_s_counts_are_correct() {
        for (a, b, expected, digits) in [
            ((7, 10), (5, 10), 0.65, 0.005),
            ((2, 10), (7, 10), 0.07, 0.005),
            ((2, 10), (6, 10), 0.17, 0.005),
            ((7, 10), (8, 10), 1.0, 1e-9),
            ((2, 10), (8, 10), 0.023, 0.0005),
            ((1, 40), (19, 40), 3e-6, 0.5e-6),
            ((19, 40), (28, 40), 0.07, 0.005),
            ((4, 30), (17, 30), 0.0009, 0.00005),
        ] {
            let p = fisher_exact(a, b);
            assert!((p - expected).abs() <= digits, "{a:?} {b:?}: {p}");
        }
    }

    #[test]
    fn the_lady_tasting_tea_has_the_published_p_value() {
        // 3 of 4 cups right: p = 34/70.
        assert!((fisher_exact((3, 4), (1, 4)) - 34.0 / 70.0).abs() < 1e-12);
    }

    #[test]
    fn empty_samples_do_not_differ() {
        assert_eq!(fisher_exact((0, 0), (3, 10)), 1.0);
        assert!((fisher_exact((0, 10), (0, 20)) - 1.0).abs() < 1e-12);
        assert!((fisher_exact((10, 10), (20, 20)) - 1.0).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn the_test_is_symmetric_in_samples_and_outcomes(
            n in 1_u64..200, m in 1_u64..200, i in 0.0..=1.0_f64, j in 0.0..=1.0_f64,
        ) {
            let (a, b) = ((i * n as f64).round() as u64, (j * m as f64).round() as u64);
            let p = fisher_exact((a, n), (b, m));
            prop_assert!(p > 0.0 && p <= 1.0);
            prop_assert!((p - fisher_exact((b, m), (a, n))).abs() < 1e-9);
            prop_assert!((p - fisher_exact((n - a, n), (m - b, m))).abs() < 1e-9);
        }
    }
}
