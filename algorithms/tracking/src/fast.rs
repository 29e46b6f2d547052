//! Single-precision elementary functions that compilers vectorise.
//!
//! They consist of additions, multiplications, comparisons and bit operations only, so they give the
//! same bits on every machine and at every vector width. Domains are those of the particle filter.

use core::f32::consts::{FRAC_2_PI, LN_2, LOG2_E, TAU};

/// Adding it to a number of magnitude below 2^22 leaves the nearest integer in the low bits.
const ROUND: f32 = 12_582_912.0;

/// π/2 in two parts; the first has few enough bits that small multiples of it are exact.
const HALF_PI_HIGH: f32 = 1.570_312_5;
const HALF_PI_LOW: f32 = 4.838_268e-4;

/// Nearest integer of a number of magnitude below 2^22, ties to even.
#[inline]
fn round(x: f32) -> f32 {
    (x + ROUND) - ROUND
}

/// Largest integer not above a number of magnitude below 2^22.
#[inline]
pub(crate) fn floor(x: f32) -> f32 {
    let nearest = round(x);
    nearest - if nearest > x { 1.0 } else { 0.0 }
}

/// Sine and cosine of an angle (rad) of magnitude below 100; absolute error below 3e-7.
#[inline]
pub fn sincos(angle: f32) -> (f32, f32) {
    let shifted = angle * FRAC_2_PI + ROUND;
    let quadrant = shifted.to_bits();
    let turns = shifted - ROUND;
    let r = (angle - turns * HALF_PI_HIGH) - turns * HALF_PI_LOW;
    let z = r * r;
    // Minimax polynomials on |r| ≤ π/4 (Cephes).
    let s = r + r * z * (-0.166_666_55 + z * (8.332_161e-3 - z * 1.951_529_6e-4));
    let c = 1.0 - 0.5 * z + z * z * (4.166_664_6e-2 + z * (-1.388_731_6e-3 + z * 2.443_315_7e-5));
    let odd = quadrant & 1 != 0;
    let (sin, cos) = if odd { (c, s) } else { (s, c) };
    // Bit 1 of the quadrant flips the sine, of the next quadrant the cosine.
    let sin_sign = (quadrant & 2) << 30;
    let cos_sign = (quadrant.wrapping_add(1) & 2) << 30;
    (
        f32::from_bits(sin.to_bits() ^ sin_sign),
        f32::from_bits(cos.to_bits() ^ cos_sign),
    )
}

/// e^−x for x ≥ 0; relative error below 3e-7 up to x = 87, exactly 0 beyond and for NaN.
#[inline]
pub fn exp_neg(x: f32) -> f32 {
    let exponent = -x.min(90.0) * LOG2_E;
    let shifted = exponent + ROUND;
    let f = exponent - (shifted - ROUND);
    // Taylor series of 2^f on |f| ≤ 1/2.
    let power = 1.0
        + f * (LN_2
            + f * (0.240_226_5
                + f * (0.055_504_11
                    + f * (9.618_129e-3 + f * (1.333_355_8e-3 + f * 1.540_353e-4)))));
    // The integer part, moved into the exponent field.
    let scale = f32::from_bits(shifted.to_bits().wrapping_add(127) << 23);
    if x < 87.0 { power * scale } else { 0.0 }
}

/// An angle (rad) of magnitude below 10^5 brought into [−π, π].
#[inline]
pub fn wrap(angle: f32) -> f32 {
    angle - TAU * round(angle * (1.0 / TAU))
}

#[cfg(test)]
mod tests {
    use geometry::math;

    use super::*;

    #[test]
    fn sine_and_cosine_are_accurate() {
        for i in -100_000..=100_000 {
            let angle = i as f32 * 1e-4;
            let (sin, cos) = sincos(angle);
            let (s, c) = math::sincos(f64::from(angle));
            assert!((f64::from(sin) - s).abs() < 3e-7, "sin {angle}");
            assert!((f64::from(cos) - c).abs() < 3e-7, "cos {angle}");
        }
    }

    #[test]
    fn exponential_is_accurate_and_ends_at_zero() {
        for i in 0..870_000 {
            let x = i as f32 * 1e-4;
            let exact = math::exp(-f64::from(x));
            // The argument times log2(e) is rounded: half an ulp of 125 is 4e-6.
            let bound = 4e-7 + 1e-7 * f64::from(x);
            assert!((f64::from(exp_neg(x)) / exact - 1.0).abs() < bound, "{x}");
        }
        assert_eq!(exp_neg(0.0), 1.0);
        for x in [87.0, 1e3, f32::MAX, f32::INFINITY, f32::NAN] {
            assert_eq!(exp_neg(x), 0.0, "{x}");
        }
    }

    #[test]
    fn wrapping_and_flooring_are_exact_enough() {
        for i in -1000..1000 {
            let angle = i as f32 * 0.037;
            let wrapped = wrap(angle);
            assert!(wrapped.abs() <= core::f32::consts::PI + 1e-5);
            let turns = (angle - wrapped) / TAU;
            assert!((turns - turns.round()).abs() < 1e-5);
            assert_eq!(floor(angle), angle.floor());
        }
        assert_eq!(floor(3.0), 3.0);
        assert_eq!(floor(-3.0), -3.0);
        assert_eq!(floor(2.5), 2.0);
        assert_eq!(floor(3.5), 3.0);
    }
}
