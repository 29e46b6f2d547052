//! Error of one parameter, and checks of single values.

use core::fmt::Display;

use thiserror::Error;

/// An invalid parameter.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub struct ParamsError {
    /// Path of the parameter inside its table, dots between levels (`limits.v_max`).
    pub field: String,
    /// Fault of the value.
    pub fault: Fault,
}

/// Fault of a parameter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fault {
    /// The value is not an accepted one.
    Value {
        /// Actual value, as text.
        found: String,
        /// Accepted values, with their unit.
        expected: String,
    },
    /// The value is rejected with a message that names it and the remedy.
    Refused(String),
}

impl Display for ParamsError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match &self.fault {
            Fault::Value { found, expected } => {
                write!(f, "`{}` is {found}: expected {expected}", self.field)
            }
            Fault::Refused(message) => f.write_str(message),
        }
    }
}

impl ParamsError {
    /// Creates an error of a field, with the actual and the accepted values.
    pub fn new(field: &str, value: &(impl Display + ?Sized), expected: impl Into<String>) -> Self {
        Self {
            field: field.to_owned(),
            fault: Fault::Value {
                found: value.to_string(),
                expected: expected.into(),
            },
        }
    }

    /// Creates an error of a field, with a complete message.
    pub fn refused(field: &str, message: impl Into<String>) -> Self {
        Self {
            field: field.to_owned(),
            fault: Fault::Refused(message.into()),
        }
    }

    /// Creates an error of the field that a message names first, in backquotes; of the whole table
    /// if it names none.
    pub fn naming(message: impl Into<String>) -> Self {
        let message = message.into();
        let field = message.split('`').nth(1).unwrap_or_default().to_owned();
        Self {
            field,
            fault: Fault::Refused(message),
        }
    }

    /// Prefixes the path with the table that contains the field's table: `v_max` becomes
    /// `limits.v_max`.
    #[must_use]
    pub fn within(mut self, table: &str) -> Self {
        self.field = match self.field.as_str() {
            "" => table.to_owned(),
            field => format!("{table}.{field}"),
        };
        self
    }
}

/// Prefixes the path of an error, for `map_err`.
pub fn within(table: &str) -> impl FnOnce(ParamsError) -> ParamsError {
    move |error| error.within(table)
}

/// Accepts a value when `ok` holds.
///
/// # Errors
/// [`ParamsError`] with these parts otherwise.
pub fn require(
    ok: bool,
    field: &str,
    value: &(impl Display + ?Sized),
    expected: impl Into<String>,
) -> Result<(), ParamsError> {
    if ok {
        Ok(())
    } else {
        Err(ParamsError::new(field, value, expected))
    }
}

/// Accepts a finite value > 0.
///
/// # Errors
/// [`ParamsError`] for any other value.
pub fn positive(field: &str, value: f64) -> Result<(), ParamsError> {
    let ok = value.is_finite() && value > 0.0;
    require(ok, field, &value, "a finite number above 0")
}

/// Accepts a finite value ≥ 0.
///
/// # Errors
/// [`ParamsError`] for any other value.
pub fn not_negative(field: &str, value: f64) -> Result<(), ParamsError> {
    let ok = value.is_finite() && value >= 0.0;
    require(ok, field, &value, "a finite number of at least 0")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_path_the_value_and_what_was_expected() {
        let error = positive("weight", -1.5).unwrap_err().within("scatter");
        assert_eq!(
            error.to_string(),
            "`scatter.weight` is -1.5: expected a finite number above 0"
        );
    }

    #[test]
    fn nothing_accepts_nan() {
        assert!(positive("x", f64::NAN).is_err());
        assert!(not_negative("x", f64::NAN).is_err());
    }
}
