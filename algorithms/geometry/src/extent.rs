//! Limits of coordinates and lengths.

use parameters::{Bounds, above, at_least, between};

/// Maximum magnitude of coordinates and lengths of maps, shapes and robots (m).
///
/// The limit is not numerical: at 100 km a position still resolves 10⁻¹¹ m, so that contacts keep
/// their tolerance.
pub const MAX_COORDINATE: f64 = 1e5;

/// Lengths and rates above 0.
pub fn positive(unit: &str) -> Bounds {
    above(0).at_most(MAX_COORDINATE).unit(unit)
}

/// Lengths and rates of at least 0.
pub fn not_negative(unit: &str) -> Bounds {
    at_least(0).at_most(MAX_COORDINATE).unit(unit)
}

/// Coordinates.
pub fn coordinate() -> Bounds {
    between(-MAX_COORDINATE, MAX_COORDINATE).unit("m")
}
