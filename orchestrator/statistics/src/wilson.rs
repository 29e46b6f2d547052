//! Wilson's score interval.

use super::interval::Interval;

/// Number of standard errors to either side that contain 95 % of a normal distribution.
pub const Z95: f64 = 1.959_963_984_540_054;

/// Returns Wilson's 95 % interval for the probability, given `hits` of `of` independent outcomes.
///
/// 0 to 1 without outcomes; more hits than outcomes count as `of`.
///
/// Source: E. B. Wilson, *Probable inference, the law of succession, and statistical inference*,
/// J. Am. Stat. Assoc. 22 (1927).
///
/// ```
/// let interval = statistics::wilson(7, 10);
/// assert_eq!(format!("{:.2} … {:.2}", interval.low, interval.high), "0.40 … 0.89");
/// ```
pub fn wilson(hits: u64, of: u64) -> Interval {
    let hits = hits.min(of);
    wilson_at(hits as f64 / of.max(1) as f64, of as f64, Z95)
}

/// Returns the same interval for a share (0 to 1) of `n` outcomes, which need not be an integer (see
/// [`Sample`](super::Sample)), `z` standard errors to either side.
pub fn wilson_at(share: f64, n: f64, z: f64) -> Interval {
    if n.is_nan() || n <= 0.0 || !share.is_finite() || !z.is_finite() {
        return Interval::UNIT;
    }
    let share = share.clamp(0.0, 1.0);
    let zz = z * z / n;
    let centre = (share + zz / 2.0) / (1.0 + zz);
    let half = (share * (1.0 - share) * zz + zz * zz / 4.0).sqrt() / (1.0 + zz);
    // The bounds are exact at 0 and 1, without rounding errors, and never exclude the share.
    let low = if share <= 0.0 { 0.0 } else { centre - half };
    let high = if share >= 1.0 { 1.0 } else { centre + half };
    Interval {
        low: low.clamp(0.0, share),
        high: high.clamp(share, 1.0),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn intervals_of_ten_games_are_wide() {
        for (hits, low, high) in [
            (0, 0.0, 0.28),
            (1, 0.02, 0.40),
            (2, 0.06, 0.51),
            (3, 0.11, 0.60),
            (5, 0.24, 0.76),
            (6, 0.31, 0.83),
            (7, 0.40, 0.89),
            (8, 0.49, 0.94),
        ] {
            let interval = wilson(hits, 10);
            assert!((interval.low - low).abs() < 0.005, "{hits}: {interval:?}");
            assert!((interval.high - high).abs() < 0.005, "{hits}: {interval:?}");
        }
    }

    #[test]
    fn published_examples_are_reproduced() {
        // R. G. Newcombe, *Two-sided confidence intervals for the single proportion*, Stat. Med. 17
        // (1998), table I, method 3.
        for (hits, of, low, high) in [
            (81, 263, 0.2553, 0.3662),
            (15, 148, 0.0624, 0.1605),
            (0, 20, 0.0, 0.1611),
            (1, 29, 0.0061, 0.1718),
        ] {
            let interval = wilson(hits, of);
            assert!(
                (interval.low - low).abs() < 5e-5,
                "{hits}/{of}: {interval:?}"
            );
            assert!(
                (interval.high - high).abs() < 5e-5,
                "{hits}/{of}: {interval:?}"
            );
        }
    }

    #[test]
    fn without_data_the_interval_is_0_to_1() {
        assert_eq!(wilson(0, 0), Interval::UNIT);
        assert_eq!(wilson_at(0.5, f64::NAN, Z95), Interval::UNIT);
        assert_eq!(wilson_at(f64::NAN, 10.0, Z95), Interval::UNIT);
        assert_eq!(wilson(20, 10), wilson(10, 10));
    }

    proptest! {
        #[test]
        fn it_contains_the_share_and_is_symmetric(of in 1_u64..5000, part in 0.0..=1.0_f64) {
            let hits = (part * of as f64).round() as u64;
            let (a, b) = (wilson(hits, of), wilson(of - hits, of));
            prop_assert!(a.contains(hits as f64 / of as f64));
            prop_assert!(0.0 <= a.low && a.high <= 1.0);
            prop_assert!((a.low + b.high - 1.0).abs() < 1e-12);
            prop_assert!((a.high + b.low - 1.0).abs() < 1e-12);
        }

        #[test]
        fn more_hits_move_it_up_and_more_data_narrow_it(of in 2_u64..3000, part in 0.0..1.0_f64) {
            let hits = (part * (of - 1) as f64).floor() as u64;
            let (a, b) = (wilson(hits, of), wilson(hits + 1, of));
            prop_assert!(a.low <= b.low && a.high <= b.high);
            prop_assert!(wilson(2 * hits, 2 * of).width() < a.width());
        }
    }
}
