//! The normal distribution.

use core::f64::consts::SQRT_2;

use geometry::math::erfc;

/// Returns the probability that a standard normal variable is larger than `z`.
pub fn upper_tail(z: f64) -> f64 {
    0.5 * erfc(z / SQRT_2)
}

/// Returns the `z` ≥ 0 that a standard normal variable exceeds with this probability.
///
/// `tail` is clamped to 10⁻³⁰⁰ … ½; NaN counts as ½.
pub fn z_of_tail(tail: f64) -> f64 {
    let tail = if tail.is_nan() {
        0.5
    } else {
        tail.clamp(1e-300, 0.5)
    };
    // The tail decreases: bisection ends at neighbouring numbers, the same on every machine.
    let (mut low, mut high) = (0.0, 40.0);
    loop {
        let middle = f64::midpoint(low, high);
        if middle <= low || middle >= high {
            return middle;
        }
        if upper_tail(middle) > tail {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Returns the number of standard errors to either side for each of `count` intervals, so that all
/// of them hold together with a probability of at least 95 % (Bonferroni). One interval: 1.96.
pub fn simultaneous_z(count: usize) -> f64 {
    z_of_tail(0.025 / count.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use statistics::Z95;

    use super::*;

    #[test]
    fn tails_and_quantiles_are_those_of_the_tables() {
        assert!((upper_tail(0.0) - 0.5).abs() < 1e-15);
        assert!((upper_tail(1.644_853_626_951_472_2) - 0.05).abs() < 1e-12);
        assert!((z_of_tail(0.025) - Z95).abs() < 1e-12);
        assert!((simultaneous_z(1) - Z95).abs() < 1e-12);
        // 0.05 / 8 to both sides together.
        assert!((simultaneous_z(8) - 2.734_368_786_533_1).abs() < 1e-9);
        assert_eq!(z_of_tail(f64::NAN), z_of_tail(0.5));
    }

    proptest! {
        #[test]
        fn quantiles_invert_tails(tail in 1e-12_f64..0.5) {
            prop_assert!((upper_tail(z_of_tail(tail)) / tail - 1.0).abs() < 1e-9);
        }
    }
}
