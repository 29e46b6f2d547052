use core::f64::consts::{FRAC_2_PI, PI};

use super::*;
use chaotic_maps::{AnySource, Key, Source as _};

fn source(key: &str) -> AnySource {
    key.parse::<Key>().unwrap().source().unwrap()
}

/// The start of the papers' tables, `x1 = 0.1`, `y1 = 0.2`, followed by `n − 1` steps.
fn table_points(kind: &str, n: usize) -> Vec<[f64; 2]> {
    let mut source = source(&format!("{kind}:0.1,0.2"));
    let first = [0.1, 0.2].map(|c: f64| match kind {
        "chebf64" => FRAC_2_PI * libm::asin(c),
        _ => c,
    });
    core::iter::once(first)
        .chain(core::iter::repeat_with(|| source.next_symmetric()))
        .take(n)
        .collect()
}

#[test]
fn the_chebyshev_map_has_the_exponent_ln_6() {
    let orbit = table_points("chebf64-raw", 10_000);
    let numeric = lyapunov_from_derivatives(orbit.iter().map(|p| chebyshev_derivative(6.0, p[0])));
    assert!((numeric - libm::log(6.0)).abs() < 1e-3, "{numeric}");
}

#[test]
fn the_derivative_is_that_of_the_polynomial() {
    for x in [-1.0, -0.99, -0.5, 0.0, 0.1, 0.7, 1.0_f64] {
        let exact = 192.0 * x.powi(5) - 192.0 * x.powi(3) + 36.0 * x;
        assert!((chebyshev_derivative(6.0, x) - exact).abs() < 1e-10, "{x}");
    }
}

#[test]
fn the_arcsine_transform_does_not_change_the_exponent() {
    let raw = |x: f64| libm::cos(6.0 * libm::acos(x.clamp(-1.0, 1.0)));
    // The map conjugated by the transform: the map of the emitted points.
    let transformed = |u: f64| FRAC_2_PI * libm::asin(raw(libm::sin(u / FRAC_2_PI)));
    let exponent = lyapunov_from_pairs(transformed, FRAC_2_PI * libm::asin(0.1), 1e-7, 10_000);
    assert!((exponent - 1.791_759).abs() < 1e-4, "{exponent}");
    // The derivative as printed gives 2.033 (and not the 3.2147 of the paper's text).
    let orbit = table_points("chebf64-raw", 10_000);
    let printed = lyapunov_from_derivatives(
        orbit
            .iter()
            .map(|p| chebyshev_derivative_as_printed(6.0, p[0])),
    );
    assert!((libm::log(24.0 / PI) - 2.033_3).abs() < 1e-4);
    assert!((printed - 2.033).abs() < 0.02, "{printed}");
}

#[test]
fn fed_back_the_transform_changes_the_map() {
    let feedback = |u: f64| FRAC_2_PI * libm::asin(libm::cos(6.0 * libm::acos(u.clamp(-1.0, 1.0))));
    let exponent = lyapunov_from_pairs(feedback, 0.1, 1e-7, 200_000);
    assert!((exponent - 1.643).abs() < 0.01, "{exponent}");
    let mut x = 0.1;
    let orbit: Vec<f64> = (0..100_000)
        .map(|_| {
            x = feedback(x);
            x
        })
        .collect();
    let mut emitted = source("chebf64:0.1,0.2");
    let output: Vec<f64> = (0..100_000).map(|_| emitted.next_symmetric()[0]).collect();
    let range = [-1.0, 1.0];
    // 49 degrees of freedom: the 99.99 % quantile is 93.
    assert!(chi_square_uniform(&output, range, 50) < 93.0);
    assert!(chi_square_uniform(&orbit, range, 50) > 150.0);
    assert!(ks_distance_uniform(&output, range) < 0.0065);
    assert!(ks_distance_uniform(&orbit, range) > 0.015);
}

#[test]
fn the_difference_of_the_axes_is_that_of_their_law() {
    // Coverage paper, Table 1: 0.8309 and 0.8209 raw, 0.6830 and 0.6758 transformed. After 21 steps
    // the values from f64 depend on the C library; the limits of the distributions do not.
    let (raw_limit, uniform_limit) = (8.0 / (PI * PI), 2.0 / 3.0);
    for (n, raw_sd, uniform_sd) in [(2000, 0.0139, 0.0114), (10_000, 0.0057, 0.0047)] {
        let raw = mean_difference(table_points("chebf64-raw", n));
        let arcsine = mean_difference(table_points("chebf64", n));
        assert!((raw - raw_limit).abs() < 3.0 * raw_sd, "{raw}");
        assert!(
            (arcsine - uniform_limit).abs() < 3.0 * uniform_sd,
            "{arcsine}"
        );
    }
}

#[test]
fn the_exact_difference_of_the_axes_over_2000_and_10_000_points() {
    let [x, y] = exact_orbits([1, 2], 10_000);
    let transformed = |c: f64| FRAC_2_PI * libm::asin(c.clamp(-1.0, 1.0));
    // Values of an independent computation with 8300 digits.
    for (n, raw, arcsine) in [(2000, 0.8245, 0.6784), (10_000, 0.8066, 0.6629)] {
        let points = || x.iter().zip(&y).map(|(&x, &y)| [x, y]).take(n);
        let v_raw = mean_difference(points());
        let v_arcsine = mean_difference(points().map(|p| p.map(transformed)));
        assert!((v_raw - raw).abs() < 6e-5, "{n}: {v_raw}");
        assert!((v_arcsine - arcsine).abs() < 6e-5, "{n}: {v_arcsine}");
    }
}

#[test]
fn the_exact_orbit_begins_as_the_one_of_floating_point() {
    let orbits = exact_orbits([1, 2], 10);
    for (i, point) in table_points("chebf64-raw", 10).iter().enumerate() {
        for (orbit, coordinate) in orbits.iter().zip(point) {
            assert!((orbit[i] - coordinate).abs() < 1e-7, "{i}");
        }
    }
}

#[test]
fn generators_that_should_be_uniform_are() {
    for key in [
        "catp:0.4,0.644",
        "cat64:12345,67890",
        "catf64:0.4,0.644",
        "chebp:123456789012345678,987654321098765432",
        "keyed:000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f",
    ] {
        let mut source = source(key);
        let points: Vec<_> = (0..50_000).map(|_| source.next_unit()).collect();
        for axis in 0..2 {
            let samples: Vec<f64> = points.iter().map(|p| p[axis]).collect();
            assert!(chi_square_uniform(&samples, [0.0, 1.0], 50) < 93.0, "{key}");
            // 2.2/√n is exceeded once in 10 000 times.
            assert!(
                ks_distance_uniform(&samples, [0.0, 1.0]) < 2.2 / 50_000_f64.sqrt(),
                "{key}"
            );
        }
    }
    let mut raw = source("chebf64-raw:0.1,0.2");
    let samples: Vec<f64> = (0..2000).map(|_| raw.next_symmetric()[0]).collect();
    assert!(chi_square_uniform(&samples, [-1.0, 1.0], 50) > 800.0);
}

#[test]
fn without_anything_to_measure_the_result_is_nan() {
    assert!(lyapunov_from_derivatives([]).is_nan());
    assert!(lyapunov_from_pairs(|x| x, 0.0, 1e-7, 0).is_nan());
    assert!(mean_difference([]).is_nan());
    assert!(chi_square_uniform(&[], [0.0, 1.0], 10).is_nan());
    assert!(chi_square_uniform(&[0.5], [0.0, 1.0], 0).is_nan());
    assert!(ks_distance_uniform(&[], [0.0, 1.0]).is_nan());
    assert_eq!(ks_distance_uniform(&[0.5], [0.0, 1.0]), 0.5);
    assert_eq!(
        chi_square_uniform(&[0.1, 0.6, -5.0, 7.0], [0.0, 1.0], 2),
        0.0
    );
}

/// A non-negative number in fixed point: from the lowest limb to the integer part.
#[derive(Clone, PartialEq)]
struct FixedPoint(Vec<u64>);

impl FixedPoint {
    fn one(fraction: usize) -> Self {
        let mut limbs = vec![0; fraction];
        limbs.push(1);
        Self(limbs)
    }

    fn multiply(&mut self, factor: u64) {
        let mut carry = 0;
        for limb in &mut self.0 {
            let product = u128::from(*limb) * u128::from(factor) + carry;
            *limb = product as u64;
            carry = product >> 64;
        }
        assert_eq!(carry, 0);
    }

    /// Truncates below the lowest limb.
    fn divide(&mut self, divisor: u64) {
        let mut rest = 0;
        for limb in self.0.iter_mut().rev() {
            let dividend = (u128::from(rest) << 64) | u128::from(*limb);
            *limb = (dividend / u128::from(divisor)) as u64;
            rest = (dividend % u128::from(divisor)) as u64;
        }
    }

    fn add(&mut self, other: &Self) {
        let mut carry = false;
        for (limb, &more) in self.0.iter_mut().zip(&other.0) {
            (*limb, carry) = sum(*limb, more, carry);
        }
        assert!(!carry);
    }

    /// Subtracts the other if it is not larger; returns `true` if it did.
    fn take(&mut self, other: &Self) -> bool {
        if self.0.iter().rev().lt(other.0.iter().rev()) {
            return false;
        }
        let mut borrow = true;
        for (limb, &less) in self.0.iter_mut().zip(&other.0) {
            (*limb, borrow) = sum(*limb, !less, borrow);
        }
        true
    }

    fn is_zero(&self) -> bool {
        self.0.iter().all(|&limb| limb == 0)
    }

    fn to_f64(&self) -> f64 {
        let add = |sum: f64, limb: &u64| sum / 18_446_744_073_709_551_616.0 + *limb as f64;
        self.0[self.0.len() - 3..].iter().fold(0.0, add)
    }

    /// The arcsine of a ratio from 0 to 1/2, by its series.
    fn arcsine(numerator: u64, denominator: u64, fraction: usize) -> Self {
        let mut power = Self::one(fraction);
        power.multiply(numerator);
        power.divide(denominator);
        let mut total = power.clone();
        let mut k = 1;
        while !power.is_zero() {
            // x^k · (1·3·…·(k − 2))/(2·4·…·(k − 1)); divided by k it is the term.
            power.multiply(numerator * numerator * k);
            power.divide(denominator * denominator * (k + 1));
            k += 2;
            let mut term = power.clone();
            term.divide(k);
            total.add(&term);
        }
        total
    }
}

/// The sum of two limbs, and the carry.
fn sum(a: u64, b: u64, carry: bool) -> (u64, bool) {
    let sum = u128::from(a) + u128::from(b) + u128::from(carry);
    (sum as u64, sum >> 64 != 0)
}

/// Orbits of the Chebyshev map of degree 6 from `x_1 = digit/10`: `x_i = cos(6^(i−1) arccos x_1)`,
/// with more digits of the angle than the steps consume (2.585 bits each).
fn exact_orbits<const N: usize>(digits: [u64; N], n: usize) -> [Vec<f64>; N] {
    // The series lose some units of the last limb: two extra limbs cover them.
    let fraction = n * 2585 / 64_000 + 5;
    let mut quarter = FixedPoint::arcsine(1, 2, fraction);
    quarter.multiply(3);
    let mut turn = quarter.clone();
    turn.multiply(4);
    digits.map(|digit| {
        let mut angle = quarter.clone();
        assert!(angle.take(&FixedPoint::arcsine(digit, 10, fraction)));
        let mut orbit = Vec::with_capacity(n);
        for _ in 0..n {
            orbit.push(libm::cos(angle.to_f64()));
            angle.multiply(6);
            while angle.take(&turn) {}
        }
        orbit
    })
}

/// Lyapunov exponent (per step) from the derivatives of a map of one variable along an orbit: the
/// mean of `ln |f'(x_n)|` (Chebyshev coverage paper, Eq. 2).
///
/// Derivatives of 0 give −∞; NaN without any derivative.
fn lyapunov_from_derivatives(derivatives: impl IntoIterator<Item = f64>) -> f64 {
    mean(derivatives.into_iter().map(|d| libm::log(d.abs())))
}

/// Derivative of the Chebyshev map `cos(k·acos x)` (Chebyshev coverage paper, Eq. 3).
///
/// At `x = ±1`, where the formula is 0/0, it is its limit `±k²`.
fn chebyshev_derivative(k: f64, x: f64) -> f64 {
    let angle = libm::acos(x.clamp(-1.0, 1.0));
    let sine = libm::sin(angle);
    if sine.abs() < 1e-8 {
        // sin(kα)/sin α → k·cos(kα)/cos α
        k * k * libm::cos(k * angle) / libm::cos(angle)
    } else {
        k * libm::sin(k * angle) / sine
    }
}

/// "Derivative after the arcsine transform" as the Chebyshev coverage paper prints it (Eq. 7):
/// `2k·sin(k·acos x) / (π·√(1 − cos²(k·acos x))·√(1 − x²))`.
///
/// It mixes two coordinates (the transformed image by the untransformed argument). So its mean
/// logarithm, `ln(4k/π)`, is not an exponent of any map; the exponent of the transformed map is
/// still `ln k`. For comparison only.
fn chebyshev_derivative_as_printed(k: f64, x: f64) -> f64 {
    let angle = libm::acos(x.clamp(-1.0, 1.0));
    let (sine, image) = (libm::sin(k * angle), libm::cos(k * angle));
    2.0 * k * sine / (PI * (1.0 - image * image).sqrt() * (1.0 - x * x).sqrt())
}

/// Pearson's χ² of samples against the uniform law on [`low`, `high`], over `bins` equal bins
/// (`bins − 1` degrees of freedom). Samples outside count in the first or the last bin.
///
/// NaN without samples or bins.
fn chi_square_uniform(samples: &[f64], [low, high]: [f64; 2], bins: usize) -> f64 {
    let mut counts = vec![0_u64; bins];
    for sample in samples {
        let bin = ((sample - low) / (high - low) * bins as f64).floor() as usize;
        if let Some(count) = counts.get_mut(bin.min(bins.saturating_sub(1))) {
            *count += 1;
        }
    }
    let expected = samples.len() as f64 / bins as f64;
    if counts.is_empty() {
        return f64::NAN;
    }
    counts
        .iter()
        .map(|&count| {
            let difference = count as f64 - expected;
            difference * difference / expected
        })
        .sum()
}

/// Kolmogorov–Smirnov distance of samples from the uniform law on [`low`, `high`]: the largest
/// difference of the two distribution functions, in [0, 1]. NaN without samples.
fn ks_distance_uniform(samples: &[f64], [low, high]: [f64; 2]) -> f64 {
    let mut sorted: Vec<f64> = samples
        .iter()
        .map(|sample| ((sample - low) / (high - low)).clamp(0.0, 1.0))
        .collect();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    sorted
        .iter()
        .enumerate()
        .map(|(i, &value)| (value - i as f64 / n).max((i + 1) as f64 / n - value))
        .reduce(f64::max)
        .unwrap_or(f64::NAN)
}
