//! Newcombe's interval of the difference of two shares.

use statistics::Interval;

/// Returns the interval of `first` − `second`, two shares of independent samples, from the Wilson
/// interval of each: its half-width is the root of the sum of squares of the half-widths to that
/// side.
///
/// Source: R. G. Newcombe, *Interval estimation for the difference between independent
/// proportions*, Stat. Med. 17 (1998), method 10.
pub fn newcombe(first: (f64, Interval), second: (f64, Interval)) -> Interval {
    let (p, q) = (first, second);
    let square = |v: f64| v * v;
    let down = (square(p.0 - p.1.low) + square(q.1.high - q.0)).sqrt();
    let up = (square(p.1.high - p.0) + square(q.0 - q.1.low)).sqrt();
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

    fn of(a: (u64, u64), b: (u64, u64)) -> Interval {
        let share = |s: (u64, u64)| (s.0 as f64 / s.1 as f64, wilson(s.0, s.1));
        newcombe(share(a), share(b))
    }

    #[test]
    fn the_examples_of_the_source_are_reproduced() {
        // Table II of the source, method 10.
        for (a, b, low, high) in [
            ((56, 70), (48, 80), 0.0524, 0.3339),
            ((9, 10), (3, 10), 0.1705, 0.8090),
            ((6, 7), (2, 7), 0.0582, 0.8062),
            ((0, 10), (0, 20), -0.1611, 0.2775),
        ] {
            let interval = of(a, b);
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

    proptest! {
        #[test]
        fn the_interval_contains_the_difference_and_is_antisymmetric(
            n in 1_u64..500, m in 1_u64..500, i in 0.0..=1.0_f64, j in 0.0..=1.0_f64,
        ) {
            let a = ((i * n as f64).round() as u64, n);
            let b = ((j * m as f64).round() as u64, m);
            let (ab, ba) = (of(a, b), of(b, a));
            let difference = a.0 as f64 / a.1 as f64 - b.0 as f64 / b.1 as f64;
            prop_assert!(ab.contains(difference));
            prop_assert!((ab.low + ba.high).abs() < 1e-12 && (ab.high + ba.low).abs() < 1e-12);
        }
    }
}
