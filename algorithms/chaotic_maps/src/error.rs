//! Errors of keys.

use parameters::ParamsError;
use thiserror::Error;

/// The names of all kinds, for messages.
pub const KINDS: &str = "catp, cat64, catf64, chebp, chebp-raw, chebf64, chebf64-raw, \
    logistic, logistic-raw, standard, keyed";

/// Reason why a key is invalid, with the remedy.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum KeyError {
    /// The text does not start with the name of a generator and a colon.
    #[error(
        "`{found}` is not a generator: expected `kind:values` with one of the kinds {}",
        KINDS
    )]
    Kind {
        /// Actual text.
        found: String,
    },
    /// An unknown name of a generator.
    #[error("`{found}` is not a generator: expected one of {}", KINDS)]
    KindName {
        /// Actual text.
        found: String,
    },
    /// Too few or too many values.
    #[error("the key `{found}` of `{kind}` has {count}: expected {expected}, separated by commas")]
    Count {
        /// Name of the generator.
        kind: String,
        /// Expected values.
        expected: &'static str,
        /// The text after the colon.
        found: String,
        /// Actual number of values.
        count: usize,
    },
    /// Not a decimal of the form `0.ddd`.
    #[error(
        "`{found}` is not a decimal key: expected `0.` and digits, such as 0.644, or a whole number"
    )]
    Decimal {
        /// Actual text.
        found: String,
    },
    /// More digits than the exact conversion allows.
    #[error("`{found}` has {digits} digits after the point: expected at most 19")]
    TooManyDigits {
        /// Actual text.
        found: String,
        /// Actual number of digits.
        digits: usize,
    },
    /// Not an integer in the range of 64 bits.
    #[error("`{found}` is no state of `{kind}`: expected a whole number from 0 to 2^64 - 1")]
    Integer {
        /// Name of the generator.
        kind: String,
        /// Actual text.
        found: String,
    },
    /// Not a number.
    #[error("`{found}` is no value of `{kind}`: expected a number such as 0.644")]
    Number {
        /// Name of the generator.
        kind: String,
        /// Actual text.
        found: String,
    },
    /// Not 64 hexadecimal digits.
    #[error(
        "the key of `keyed` has {length} characters{}: expected 64 hexadecimal digits (32 bytes)",
        if *.length == 64 { ", some of which are not hexadecimal digits" } else { "" }
    )]
    Hex {
        /// Actual number of characters (the error does not contain the key itself: it is a secret).
        length: usize,
    },
    /// A value outside the range of the state.
    #[error("`{name}` of `{kind}` is {value}: expected {expected}")]
    OutOfRange {
        /// Name of the generator.
        kind: String,
        /// Name of the value.
        name: &'static str,
        /// The value.
        value: String,
        /// Expected value.
        expected: &'static str,
    },
    /// All values are zero, which is a fixed point of the map.
    #[error("the key of `{kind}` is all zero, a fixed point: make at least one value other than 0")]
    Zero {
        /// Name of the generator.
        kind: String,
    },
    /// Both halves of the state of a wrapping cat map are even.
    #[error(
        "both values of `{kind}` are even ({a}, {b}), which shortens the period: make one of them odd"
    )]
    Even {
        /// Name of the generator.
        kind: String,
        /// First value.
        a: u64,
        /// Second value.
        b: u64,
    },
    /// The second coordinate would repeat or mirror the first one.
    #[error(
        "the values {x} and {y} of `{kind}` are equal or mirrored, so that all points lie on a \
         diagonal: change one of them"
    )]
    Linked {
        /// Name of the generator.
        kind: String,
        /// First value.
        x: String,
        /// Second value.
        y: String,
    },
    /// A value that is a fixed point, or leads to one in a step or two.
    #[error(
        "`{name}` of `{kind}` is {value}, which leads to a fixed point ({values}): choose a value \
         away from these"
    )]
    FixedPoint {
        /// Name of the generator.
        kind: String,
        /// Name of the value.
        name: &'static str,
        /// The value.
        value: f64,
        /// The values that lead to a fixed point.
        values: &'static str,
    },
    /// The period of the orbit is short.
    #[error(
        "the key ({x}, {y}) of `{kind}` repeats after {period} steps, because its values are \
         multiples of a large power of 1/2: choose values with more digits, such as 0.4 and 0.644"
    )]
    ShortPeriod {
        /// Name of the generator.
        kind: String,
        /// First value.
        x: f64,
        /// Second value.
        y: f64,
        /// Exact period (steps).
        period: u64,
    },
    /// The values stay so small that the map does not mix for many steps.
    #[error(
        "the values ({x}, {y}) of `{kind}` are too small for the map to mix them within {steps} \
         steps: choose values above 1e-300"
    )]
    TooSmall {
        /// Name of the generator.
        kind: String,
        /// First value.
        x: f64,
        /// Second value.
        y: f64,
        /// Number of steps tried.
        steps: u32,
    },
    /// A key of a generator that does not keep a secret, where a secret is required.
    #[error("`{kind}` keeps no secret: expected `keyed:` and 64 hexadecimal digits")]
    NotSecret {
        /// Name of the generator.
        kind: String,
    },
}

/// The error of a key is an error of the parameter `key`.
impl From<KeyError> for ParamsError {
    fn from(error: KeyError) -> Self {
        Self::refused("key", format!("`key`: {error}"))
    }
}
