//! Checks on single values, and the error that names what is wrong with one.

use core::fmt::Display;

/// Largest coordinate or length that a map, shape or robot may have [m].
///
/// A limit of sense rather than of arithmetic: at 100 km a position still resolves 10⁻¹¹ m, so
/// that contacts keep their tolerance.
pub const MAX_COORDINATE: f64 = 1e5;

/// A value of a specification that is out of its range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{field} = {value}: expected {expected}")]
pub struct FieldError {
    /// The field, as written in the scenario, with the path to it (`limits.v_max`).
    pub field: String,
    /// The value that was given.
    pub value: String,
    /// What would have been accepted, with its unit.
    pub expected: String,
}

impl FieldError {
    pub(crate) fn new(field: &str, value: impl Display, expected: impl Into<String>) -> Self {
        Self {
            field: field.to_owned(),
            value: value.to_string(),
            expected: expected.into(),
        }
    }

    /// The same error one table further out: `v_max` becomes `limits.v_max`.
    #[must_use]
    pub fn within(mut self, table: &str) -> Self {
        self.field = format!("{table}.{}", self.field);
        self
    }
}

/// `Ok` if the condition holds, otherwise the error with these parts.
pub(crate) fn check(
    holds: bool,
    field: &str,
    value: impl Display,
    expected: impl Into<String>,
) -> Result<(), FieldError> {
    if holds {
        Ok(())
    } else {
        Err(FieldError::new(field, value, expected))
    }
}

/// Requires a finite number > 0 that is not absurdly large.
pub(crate) fn positive(field: &str, value: f64, unit: &str) -> Result<(), FieldError> {
    check(
        value > 0.0 && value <= MAX_COORDINATE,
        field,
        value,
        format!("a number > 0 and ≤ {MAX_COORDINATE} [{unit}]"),
    )
}

/// Requires a finite number ≥ 0 that is not absurdly large.
pub(crate) fn non_negative(field: &str, value: f64, unit: &str) -> Result<(), FieldError> {
    check(
        (0.0..=MAX_COORDINATE).contains(&value),
        field,
        value,
        format!("a number ≥ 0 and ≤ {MAX_COORDINATE} [{unit}]"),
    )
}

/// Requires a coordinate within ±[`MAX_COORDINATE`].
pub(crate) fn coordinate(field: &str, value: f64) -> Result<(), FieldError> {
    check(
        value.abs() <= MAX_COORDINATE,
        field,
        value,
        format!("a number within ±{MAX_COORDINATE} [m]"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_field_value_and_expectation() {
        let error = positive("v_max", -0.5, "m/s").unwrap_err().within("limits");
        assert_eq!(
            error.to_string(),
            "limits.v_max = -0.5: expected a number > 0 and ≤ 100000 [m/s]"
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
