//! Sequences of the Chebyshev coverage paper.

use core::f64::consts::FRAC_2_PI;

use chaotic_maps::{ChebF64, ChebP, Emission, KeyError};
use geometry::math::{acos, asin, cos, sin};
use metrics::sequence::{lyapunov_from_pairs, mean_difference};
use rand::RngExt as _;
use runtime::seed::stream;

/// First values of the paper.
const FIRST: [f64; 2] = [0.1, 0.2];

/// Key of the exact map for a seed.
pub fn key(seed: u64) -> [u64; 2] {
    let mut random = stream(seed, "reproduce", "", "chebyshev");
    [random.random::<u64>() >> 1, random.random::<u64>() >> 1]
}

/// Mean difference of the coordinates of `count` points: of the exact map under a key, else in floating point from the
/// paper's first values.
///
/// # Errors
/// A key that the map does not take.
pub fn difference(
    emission: Emission,
    count: usize,
    key: Option<[u64; 2]>,
) -> Result<f64, KeyError> {
    let Some([tx, ty]) = key else {
        let [x, y] = FIRST;
        let mut map = ChebF64::new(x, y, emission)?;
        // The first values are the first pair.
        return Ok(mean_difference((0..count).map(|_| {
            let pair = map.point();
            map.step();
            pair
        })));
    };
    let mut map = ChebP::new(tx, ty, emission)?;
    Ok(mean_difference((0..count).map(|_| {
        map.step();
        map.point()
    })))
}

/// Lyapunov exponents (per step) along orbits of the map and of its arcsine transform, from the same start.
pub fn exponents() -> [f64; 2] {
    let raw = |x: f64| cos(6.0 * acos(x.clamp(-1.0, 1.0)));
    let transformed = |u: f64| FRAC_2_PI * asin(raw(sin(u / FRAC_2_PI)));
    let along = |map: &dyn Fn(f64) -> f64, start| lyapunov_from_pairs(map, start, 1e-7, 10_000);
    [along(&raw, 0.1), along(&transformed, FRAC_2_PI * asin(0.1))]
}
