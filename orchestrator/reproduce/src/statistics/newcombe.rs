//! Newcombe's interval of the difference of two shares.

use statistics::Interval;

/// Returns the interval of `first` − `second`, two shares with their Wilson intervals, measured on the same
/// cases with this correlation of their outcomes (−1 to 1; 0 for independent samples).
///
/// Sources: R. G. Newcombe, *Improved confidence intervals for the difference between binomial proportions
/// based on paired data*, Stat. Med. 17 (1998), method 8; for independent samples the same author's
/// *Interval estimation for the difference between independent proportions*, ibid., method 10.
pub fn newcombe(first: (f64, Interval), second: (f64, Interval), correlation: f64) -> Interval {
    let (p, q) = (first, second);
    let side = |a: f64, b: f64| (a * a - 2.0 * correlation * a * b + b * b).max(0.0).sqrt();
    let down = side(p.0 - p.1.low, q.1.high - q.0);
    let up = side(p.1.high - p.0, q.0 - q.1.low);
    let difference = p.0 - q.0;
    Interval {
        low: (difference - down).max(-1.0),
        high: (difference + up).min(1.0),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use statistics::wilson;

    use super::*;

    fn share((hits, of): (u64, u64)) -> (f64, Interval) {
        (hits as f64 / of as f64, wilson(hits, of))
    }

    #[test]
    fn the_examples_of_the_source_are_reproduced() {
        // Table II of the source on independent samples, method 10.
        for (a, b, low, high) in [
            ((56, 70), (48, 80), 0.0524, 0.3339),
            ((9, 10), (3, 10), 0.1705, 0.8090),
            ((6, 7), (2, 7), 0.0582, 0.8062),
            ((0, 10), (0, 20), -0.1611, 0.2775),
        ] {
            let interval = newcombe(share(a), share(b), 0.0);
            assert!(
                (interval.low - low).abs() < 1e-4,
                "{a:?} {b:?}: {interval:?}"
            );
            assert!(
                (interval.high - high).abs() < 1e-4,
                "{a:?} {b:?}: {interval:?}"
            );
        }
    }

    #[test]
    fn a_correlation_narrows_the_interval() {
        // 50 pairs: 20 hits on both sides, 12 on the first, 2 on the second, 16 on none. By hand:
        // φ = (20 · 16 − 12 · 2) / √(32 · 18 · 22 · 28) = 0.4969; 32/50: 0.5014 … 0.7586;
        // 22/50: 0.3116 … 0.5769.
        let phi = 296.0 / f64::sqrt(32.0 * 18.0 * 22.0 * 28.0);
        let interval = newcombe(share((32, 50)), share((22, 50)), phi);
        assert!((interval.low - 0.0618).abs() < 1e-4, "{interval:?}");
        assert!((interval.high - 0.3242).abs() < 1e-4, "{interval:?}");
    }

    proptest! {
        #[test]
        fn the_interval_contains_the_difference_and_is_antisymmetric(
            n in 1_u64..500, m in 1_u64..500, i in 0.0..=1.0_f64, j in 0.0..=1.0_f64, r in -1.0..=1.0_f64,
        ) {
            let a = ((i * n as f64).round() as u64, n);
            let b = ((j * m as f64).round() as u64, m);
            let (ab, ba) = (newcombe(share(a), share(b), r), newcombe(share(b), share(a), r));
            let difference = share(a).0 - share(b).0;
            prop_assert!(ab.low - 1e-12 <= difference && difference <= ab.high + 1e-12);
            prop_assert!((ab.low + ba.high).abs() < 1e-12 && (ab.high + ba.low).abs() < 1e-12);
        }
    }
}
