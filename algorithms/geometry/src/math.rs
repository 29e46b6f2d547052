//! Elementary functions that compute the same bits on every machine.
//!
//! The standard library's `f64::sin` and similar functions call the C library, whose dispatcher
//! selects a variant (with or without fused multiply–add) by processor. The last bit may differ,
//! and a chaotic chase turns a last bit into another history. `libm` is pure Rust and always the
//! same. `clippy.toml` disallows the standard methods everywhere.

use core::f64::consts::{PI, TAU};

pub use libm::{
    acos, asin, atan, atan2, cbrt, cos, exp, hypot, log as ln, pow, sin, sincos, tan, tanh,
};
pub use libm::{cosf, expf, logf as lnf, sincosf, sinf, tanhf};
pub use libm::{erfc, lgamma as ln_gamma};

/// Wraps an angle (rad) into (−π, π].
///
/// Non-finite input gives NaN.
pub fn wrap_angle(angle: f64) -> f64 {
    let wrapped = angle - TAU * ((angle + PI) / TAU).floor();
    // `floor` maps +π to −π; the interval's closed end is the positive one.
    if wrapped <= -PI {
        wrapped + TAU
    } else {
        wrapped
    }
}

/// The signed shortest rotation (rad) from `from` to `to`, in (−π, π].
///
/// ```
/// use core::f64::consts::PI;
/// use geometry::math::angle_difference;
///
/// assert!((angle_difference(-0.9 * PI, 0.9 * PI) - 0.2 * PI).abs() < 1e-12);
/// ```
pub fn angle_difference(to: f64, from: f64) -> f64 {
    wrap_angle(to - from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapped_angles_lie_in_the_half_open_interval() {
        assert_eq!(wrap_angle(0.0), 0.0);
        assert_eq!(wrap_angle(PI), PI);
        assert_eq!(wrap_angle(-PI), PI);
        assert!((wrap_angle(3.0 * PI) - PI).abs() < 1e-12);
        assert!((wrap_angle(-0.5 - 4.0 * TAU) + 0.5).abs() < 1e-12);
        assert!(wrap_angle(f64::NAN).is_nan());
    }

    #[test]
    fn the_difference_is_the_shorter_rotation() {
        assert!((angle_difference(-3.0, 3.0) - (TAU - 6.0)).abs() < 1e-12);
        assert!((angle_difference(0.1, -0.1) - 0.2).abs() < 1e-12);
    }
}
