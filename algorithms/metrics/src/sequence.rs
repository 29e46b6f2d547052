//! Metrics of sequences of numbers and points: divergence of close orbits, and distribution of
//! points.
//!
//! None of these measures predictability: both papers' maps have large exponents, yet a hundred
//! points determine them exactly.

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

/// `v(xy)`, the mean of `|x_i − y_i|` (Chebyshev coverage paper, Eq. 6); NaN without points.
///
/// For independent coordinates it depends only on their distribution (8/π² for the arcsine law, 2/3
/// for the uniform one on [−1, 1]) and does not measure randomness.
pub fn mean_difference(points: impl IntoIterator<Item = [f64; 2]>) -> f64 {
    mean(points.into_iter().map(|[x, y]| (x - y).abs()))
}

/// Mean in the order of the values; NaN without any.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_u64), |(sum, count), value| (sum + value, count + 1));
    sum / count as f64
}

#[cfg(test)]
mod tests;
