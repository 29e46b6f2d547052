//! Checks of lengths and coordinates, which have a limit of sense.

use crate::params::{ParamsError, require};

/// Largest coordinate or length that a map, shape or robot may have (m).
///
/// A limit of sense rather than of arithmetic: at 100 km a position still resolves 10⁻¹¹ m, so
/// that contacts keep their tolerance.
pub const MAX_COORDINATE: f64 = 1e5;

/// Requires a finite number > 0 that is not absurdly large.
pub(crate) fn positive(field: &str, value: f64, unit: &str) -> Result<(), ParamsError> {
    require(
        value > 0.0 && value <= MAX_COORDINATE,
        field,
        &value,
        format!("a number > 0 and ≤ {MAX_COORDINATE} [{unit}]"),
    )
}

/// Requires a finite number ≥ 0 that is not absurdly large.
pub(crate) fn non_negative(field: &str, value: f64, unit: &str) -> Result<(), ParamsError> {
    require(
        (0.0..=MAX_COORDINATE).contains(&value),
        field,
        &value,
        format!("a number ≥ 0 and ≤ {MAX_COORDINATE} [{unit}]"),
    )
}

/// Requires a coordinate within ±[`MAX_COORDINATE`].
pub(crate) fn coordinate(field: &str, value: f64) -> Result<(), ParamsError> {
    require(
        value.abs() <= MAX_COORDINATE,
        field,
        &value,
        format!("a number within ±{MAX_COORDINATE} [m]"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_a_sensible_length_is_refused() {
        let error = positive("v_max", -0.5, "m/s").unwrap_err().within("limits");
        assert_eq!(
            error.to_string(),
            "`limits.v_max` is -0.5, but must be a number > 0 and ≤ 100000 [m/s]"
        );
        for bad in [f64::NAN, f64::INFINITY, 0.0] {
            assert!(positive("x", bad, "m").is_err());
        }
        assert!(non_negative("x", 0.0, "m").is_ok());
        assert!(non_negative("x", f64::NAN, "m").is_err());
        assert!(coordinate("x", -1e5).is_ok());
        assert!(coordinate("x", f64::NAN).is_err());
    }
}
