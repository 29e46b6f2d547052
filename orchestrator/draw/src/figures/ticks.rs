//! Ticks of an axis.

/// Ticks of an axis at round values.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ticks {
    /// Lower end of the axis, at most the first tick.
    pub(super) low: f64,
    /// Upper end of the axis, at least the last tick.
    pub(super) high: f64,
    /// Values of the ticks, ascending.
    pub(super) values: Vec<f64>,
}

/// Maximum magnitude of values; differences of larger ones overflow.
const MAX_MAGNITUDE: f64 = 1e150;

impl Ticks {
    /// Returns about `count` steps of 1, 2, 2.5 or 5 times a power of ten that cover the values; the ends are
    /// rounded outwards to the next step. Ends that are not finite or equal give an axis around the finite
    /// one.
    pub(super) fn over(low: f64, high: f64, count: f64) -> Self {
        let finite = |v: f64, other: f64| {
            let v = if v.is_finite() { v } else { other };
            v.clamp(-MAX_MAGNITUDE, MAX_MAGNITUDE)
        };
        let (low, high) = (finite(low, 0.0), finite(high, 1.0));
        let (low, high) = if low < high {
            (low, high)
        } else {
            let room = (low.abs() * 0.1).max(0.5);
            (low - room, low + room)
        };
        let step = step((high - low) / count);
        // The margin absorbs rounding errors of steps that divide the ends exactly.
        let (first, last) = ((low / step + 1e-9).floor(), (high / step - 1e-9).ceil());
        let values: Vec<f64> = (0..=(last - first).clamp(0.0, 1000.0) as u32)
            .map(|i| (first + f64::from(i)) * step)
            .collect();
        Self {
            low: first * step,
            high: last * step,
            values,
        }
    }

    /// Returns ticks at these values, with a margin beyond the outer ones.
    pub(super) fn at(mut values: Vec<f64>) -> Self {
        for value in &mut values {
            *value = value.clamp(-MAX_MAGNITUDE, MAX_MAGNITUDE);
        }
        values.sort_by(f64::total_cmp);
        values.dedup();
        let (low, high) = match (values.first(), values.last()) {
            (Some(&low), Some(&high)) => (low, high),
            _ => (0.0, 1.0),
        };
        let room = if low < high { (high - low) * 0.05 } else { 0.5 };
        Self {
            low: low - room,
            high: high + room,
            values,
        }
    }
}

/// Returns the smallest round number that is at least `least`, which is positive.
fn step(least: f64) -> f64 {
    let least = least.max(1e-100);
    let mut power = 1.0;
    while power > least {
        power /= 10.0;
    }
    while power * 10.0 <= least {
        power *= 10.0;
    }
    let rounds = [1.0, 2.0, 2.5, 5.0, 10.0];
    let fitting = rounds.iter().find(|&&r| r * power >= least * (1.0 - 1e-9));
    fitting.copied().unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn steps_are_round() {
        for (least, expected) in [
            (0.2, 0.2),
            (0.21, 0.25),
            (3.0, 5.0),
            (70.0, 100.0),
            (1.0, 1.0),
        ] {
            assert!((step(least) - expected).abs() < 1e-9 * expected, "{least}");
        }
    }

    #[test]
    fn shares_are_divided_into_fifths() {
        let ticks = Ticks::over(0.0, 1.0, 5.0);
        assert_eq!((ticks.low, ticks.high, ticks.values.len()), (0.0, 1.0, 6));
    }

    #[test]
    fn degenerate_ranges_have_an_axis() {
        for (low, high) in [
            (3.0, 3.0),
            (0.0, 0.0),
            (f64::NAN, 1.0),
            (f64::NEG_INFINITY, f64::INFINITY),
            (5.0, -5.0),
        ] {
            let ticks = Ticks::over(low, high, 5.0);
            assert!(
                ticks.low < ticks.high && ticks.values.len() >= 2,
                "{low} {high}: {ticks:?}"
            );
        }
        assert!(Ticks::at(vec![2.0]).low < 2.0);
        assert_eq!(Ticks::at(Vec::new()).values.len(), 0);
    }

    proptest! {
        #[test]
        fn ticks_cover_the_range(low in -1e6_f64..1e6, width in 1e-3_f64..1e6) {
            let ticks = Ticks::over(low, low + width, 6.0);
            prop_assert!(ticks.low <= low + 1e-6 * width && ticks.high >= low + width * (1.0 - 1e-6));
            prop_assert!((2..=10).contains(&ticks.values.len()), "{:?}", ticks);
        }
    }
}
