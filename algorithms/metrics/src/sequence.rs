//! Metrics of sequences of numbers and points: divergence of close orbits, and distribution of
//! points.
//!
//! None of these measures predictability: both papers' maps have large exponents, yet a hundred
//! points determine them exactly.

use core::f64::consts::PI;

/// Lyapunov exponent (per step) from the derivatives of a map of one variable along an orbit: the
/// mean of `ln |f'(x_n)|` (Chebyshev coverage paper, Eq. 2).
///
/// Derivatives of 0 give −∞; NaN without any derivative.
pub fn lyapunov_from_derivatives(derivatives: impl IntoIterator<Item = f64>) -> f64 {
    mean(derivatives.into_iter().map(|d| libm::log(d.abs())))
}

/// Largest Lyapunov exponent (per step) from the Jacobians of a map of the plane along an orbit
/// (rows first): the mean growth of a tangent vector, renormalised at every step.
///
/// The vector starts along (1, 1)/√2 and takes some ten steps to turn into the expanding direction;
/// over `n` steps that costs an error of the order of `1/n`. NaN without any Jacobian; −∞ when a
/// Jacobian takes the vector to 0.
pub fn lyapunov_from_jacobians(jacobians: impl IntoIterator<Item = [[f64; 2]; 2]>) -> f64 {
    let mut tangent = [0.5_f64.sqrt(); 2];
    mean(jacobians.into_iter().map(|[[a, b], [c, d]]| {
        let [x, y] = tangent;
        let image = [a * x + b * y, c * x + d * y];
        let length = libm::hypot(image[0], image[1]);
        if length > 0.0 {
            tangent = image.map(|component| component / length);
        }
        libm::log(length)
    }))
}

/// Lyapunov exponent (per step) of any map of one variable, by a second orbit at distance
/// `separation` that is reset to that distance after each step.
///
/// Needs no derivative, and so shows that a change of coordinates does not change the exponent.
/// Steps from which both orbits coincide are left out. NaN without steps.
pub fn lyapunov_from_pairs(
    map: impl Fn(f64) -> f64,
    start: f64,
    separation: f64,
    steps: usize,
) -> f64 {
    let mut x = start;
    mean((0..steps).filter_map(|_| {
        let (image, neighbour) = (map(x), map(x + separation));
        x = image;
        let growth = ((neighbour - image) / separation).abs();
        (growth > 0.0).then(|| libm::log(growth))
    }))
}

/// Derivative of the Chebyshev map `cos(k·acos x)` (Chebyshev coverage paper, Eq. 3).
///
/// At `x = ±1`, where the formula is 0/0, it is its limit `±k²`.
pub fn chebyshev_derivative(k: f64, x: f64) -> f64 {
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
pub fn chebyshev_derivative_as_printed(k: f64, x: f64) -> f64 {
    let angle = libm::acos(x.clamp(-1.0, 1.0));
    let (sine, image) = (libm::sin(k * angle), libm::cos(k * angle));
    2.0 * k * sine / (PI * (1.0 - image * image).sqrt() * (1.0 - x * x).sqrt())
}

/// `v(xy)`, the mean of `|x_i − y_i|` (Chebyshev coverage paper, Eq. 6); NaN without points.
///
/// For independent coordinates it depends only on their distribution (8/π² for the arcsine law, 2/3
/// for the uniform one on [−1, 1]) and does not measure randomness.
pub fn mean_difference(points: impl IntoIterator<Item = [f64; 2]>) -> f64 {
    mean(points.into_iter().map(|[x, y]| (x - y).abs()))
}

/// Pearson's χ² of samples against the uniform law on [`low`, `high`], over `bins` equal bins
/// (`bins − 1` degrees of freedom). Samples outside count in the first or the last bin.
///
/// NaN without samples or bins.
pub fn chi_square_uniform(samples: &[f64], [low, high]: [f64; 2], bins: usize) -> f64 {
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
pub fn ks_distance_uniform(samples: &[f64], [low, high]: [f64; 2]) -> f64 {
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

/// Mean in the order of the values; NaN without any.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_u64), |(sum, count), value| (sum + value, count + 1));
    sum / count as f64
}

#[cfg(test)]
mod tests;
