//! Sine and cosine of several angles at once.
//!
//! The lanes have no branches, so that the compiler computes two and more at the same time; sums and
//! products keep their order, so that every machine computes the same bits. Reduction and polynomials
//! are those of `libm`.

use core::f64::consts::FRAC_2_PI;

use geometry::math;

/// Angles (rad) below which the quarter turns are exact.
const MAX_ANGLE: f64 = 1e5;
/// A number that rounds to an integer what is added to it.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// The first 33 bits of π/2, and the rest.
const QUARTER: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];
/// Coefficients of sin r − r, from r³ on.
const SIN: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
/// Coefficients of cos r − 1 + r²/2, from r⁴ on.
const COS: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Sines and cosines of angles (rad).
pub fn sincos<const N: usize>(angles: [f64; N]) -> [[f64; N]; 2] {
    let (mut sin, mut cos) = ([0.0; N], [0.0; N]);
    if !angles.iter().all(|angle| angle.abs() < MAX_ANGLE) {
        for i in 0..N {
            (sin[i], cos[i]) = math::sincos(angles[i]);
        }
        return [sin, cos];
    }
    for i in 0..N {
        let rounded = angles[i] * FRAC_2_PI + ROUND;
        let quarters = rounded - ROUND;
        let rest = (angles[i] - quarters * QUARTER[0]) - quarters * QUARTER[1];
        let square = rest * rest;
        let s = rest + rest * square * polynomial(&SIN, square);
        let c = 1.0 - (0.5 * square - square * square * polynomial(&COS, square));
        // The last two bits count the quarter turns: they swap sine and cosine, and change signs.
        let bits = rounded.to_bits();
        let swap = (bits & 1).wrapping_neg();
        let (s, c) = (s.to_bits(), c.to_bits());
        let differ = (s ^ c) & swap;
        sin[i] = f64::from_bits(s ^ differ ^ ((bits & 2) << 62));
        cos[i] = f64::from_bits(c ^ differ ^ ((bits.wrapping_add(1) & 2) << 62));
    }
    [sin, cos]
}

/// c₀ + c₁ z + c₂ z² + …
fn polynomial(coefficients: &[f64; 6], z: f64) -> f64 {
    let [a, b, c, d, e, f] = coefficients;
    a + z * (b + z * (c + z * (d + z * (e + z * f))))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn check(angle: f64) {
        let [sin, cos] = sincos([angle, -angle, 0.0, angle]);
        let exact = math::sincos(angle);
        assert!((sin[0] - exact.0).abs() <= 2.5e-16, "sin {angle}");
        assert!((cos[0] - exact.1).abs() <= 2.5e-16, "cos {angle}");
        assert_eq!((sin[1], cos[1]), (-sin[0], cos[0]), "symmetry at {angle}");
        assert_eq!((sin[3], cos[3]), (sin[0], cos[0]));
        assert_eq!((sin[2], cos[2]), (0.0, 1.0));
    }

    proptest! {
        #[test]
        fn sines_are_those_of_libm(small in -10.0..10.0f64, large in -MAX_ANGLE..MAX_ANGLE) {
            check(small);
            check(large);
        }
    }

    #[test]
    fn sines_near_quarter_turns_are_those_of_libm() {
        for eighths in -1000..=1000 {
            let angle = f64::from(eighths) * core::f64::consts::FRAC_PI_4;
            check(angle);
            check(angle.next_up());
            check(angle.next_down());
        }
    }

    #[test]
    fn sines_have_the_same_bits_everywhere() {
        let digest = (0..10_000).fold(0u64, |digest, i| {
            let angle = f64::from(i) * 0.003_7 - 18.0;
            let [sin, cos] = sincos([angle, 1e3 * angle, 1.0 - angle, 1e-9 * angle]);
            let values = sin.into_iter().chain(cos);
            values.fold(digest, |digest, x| digest.rotate_left(7) ^ x.to_bits())
        });
        assert_eq!(digest, 0x7961_8950_d9f5_0017, "{digest:#x}");
    }

    #[test]
    fn angles_beyond_the_range_are_those_of_libm() {
        let angles = [MAX_ANGLE, -1e9, 1e300, 0.3];
        let [sin, cos] = sincos(angles);
        for (i, angle) in angles.into_iter().enumerate() {
            assert_eq!((sin[i], cos[i]), math::sincos(angle));
        }
        for angle in [f64::NAN, f64::INFINITY] {
            let [sin, cos] = sincos([angle, 0.0]);
            assert!(sin[0].is_nan() && cos[0].is_nan());
            assert_eq!((sin[1], cos[1]), (0.0, 1.0));
        }
    }
}
