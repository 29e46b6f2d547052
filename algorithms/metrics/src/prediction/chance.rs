//! Errors of an observer that can only guess: medians for independent uniform goals. The ratio of
//! an observer's median to them measures the predictability of a sequence of goals; 1 means
//! unpredictable.

/// Number of intervals of the quadrature; even.
const INTERVALS: usize = 2000;

/// Median distance of two independent points, uniform over a rectangle of these sides (m).
///
/// Sides that are negative or not finite count as 0.
pub fn chance_median(width: f64, height: f64) -> f64 {
    let [w, h] = [width, height].map(|s| if s.is_finite() { s.max(0.0) } else { 0.0 });
    if w == 0.0 || h == 0.0 {
        return chance_median_along(w.max(h));
    }
    let (mut low, mut high) = (0.0, libm::hypot(w, h));
    // Every step gives one bit.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if within(middle, w, h) < 0.5 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Median distance of two independent numbers, uniform over an interval of this length.
pub fn chance_median_along(length: f64) -> f64 {
    // P(|d| < t) = 1 − (1 − t/L)².
    length * (1.0 - 0.5_f64.sqrt())
}

/// Probability that the distance is below `t`: the offsets along the sides are independent with
/// triangular densities. Simpson's rule over the angle of a = t sin φ, in which the edge is smooth.
fn within(t: f64, w: f64, h: f64) -> f64 {
    let steepest = if t <= w {
        core::f64::consts::FRAC_PI_2
    } else {
        libm::asin(w / t)
    };
    let step = steepest / INTERVALS as f64;
    let value = |k: usize| {
        let (sin, cos) = libm::sincos(step * k as f64);
        let density = 2.0 * (w - t * sin).max(0.0) / (w * w);
        let part = ((t * cos) / h).min(1.0);
        density * part * (2.0 - part) * t * cos
    };
    let inner: f64 = (1..INTERVALS)
        .map(|k| if k % 2 == 1 { 4.0 } else { 2.0 } * value(k))
        .sum();
    (value(0) + inner + value(INTERVALS)) * step / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_those_of_the_closed_forms() {
        // Unit square, d ≤ 1: P(d) = πd² − 8d³/3 + d⁴/2.
        let d = chance_median(1.0, 1.0);
        let p = core::f64::consts::PI * d * d - 8.0 * d * d * d / 3.0 + 0.5 * d * d * d * d;
        assert!((p - 0.5).abs() < 1e-6, "{d} {p}");
        assert!((chance_median(2.0, 2.0) - 2.0 * d).abs() < 1e-9);
        assert!((chance_median_along(2.0) - 0.585_786_437_626_905).abs() < 1e-12);
    }

    #[test]
    fn a_thin_rectangle_is_a_line_and_invalid_sides_count_as_zero() {
        let thin = chance_median(3.0, 1e-6);
        assert!((thin - chance_median_along(3.0)).abs() < 1e-4, "{thin}");
        assert_eq!(chance_median(3.0, 0.0), chance_median_along(3.0));
        assert_eq!(chance_median(0.0, f64::NAN), 0.0);
        assert_eq!(chance_median(1.5, 0.5), chance_median(1.5, 0.5));
        assert!((chance_median(1.5, 0.5) - chance_median(0.5, 1.5)).abs() < 1e-6);
    }
}
