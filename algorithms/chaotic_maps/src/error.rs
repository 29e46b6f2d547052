//! What can be wrong with a key.

use parameters::ParamsError;
use thiserror::Error;

/// The names of all kinds, for messages.
pub(crate) const KINDS: &str = "catp, cat64, catf64, chebp, chebp-raw, chebf64, chebf64-raw, \
    logistic, logistic-raw, standard, keyed";

/// A key that cannot be used, and what to change.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum KeyError {
    /// The text does not start with the name of a generator and a colon.
    #[error(
        "`{found}` names no generator; write `kind:values` with one of the kinds {}",
        KINDS
    )]
    Kind {
        /// The text found.
        found: String,
    },
    /// A name that no generator has.
    #[error("`{found}` names no generator; use one of {}", KINDS)]
    KindName {
        /// The text found.
        found: String,
    },
    /// Too few or too many values.
    #[error("a key of `{kind}` has {expected}, separated by commas, but `{found}` has {count}")]
    Count {
        /// The generator.
        kind: String,
        /// What it takes.
        expected: &'static str,
        /// The text after the colon.
        found: String,
        /// How many values that has.
        count: usize,
    },
    /// Not a decimal of the form `0.ddd`.
    #[error("`{found}` is no decimal key; write `0.` and digits, such as 0.644, or a whole number")]
    Decimal {
        /// The text found.
        found: String,
    },
    /// More digits than the exact conversion takes.
    #[error("`{found}` has {digits} digits after the point; at most 19 are used, drop the others")]
    TooManyDigits {
        /// The text found.
        found: String,
        /// How many it has.
        digits: usize,
    },
    /// Not a whole number in the range of 64 bits.
    #[error(
        "`{found}` is no whole number from 0 to 2^64 - 1, which is what the state of `{kind}` is \
         made of"
    )]
    Integer {
        /// The generator.
        kind: String,
        /// The text found.
        found: String,
    },
    /// Not a number at all.
    #[error("`{found}` is no number; `{kind}` takes numbers such as 0.644")]
    Number {
        /// The generator.
        kind: String,
        /// The text found.
        found: String,
    },
    /// Not 64 hexadecimal digits.
    #[error(
        "the key of `keyed` must be 64 hexadecimal digits (32 bytes), but has {length} characters{}",
        if *.length == 64 { ", some of which are no such digits" } else { "" }
    )]
    Hex {
        /// How many characters were found (the key itself is not repeated: it is a secret).
        length: usize,
    },
    /// A value outside the range of the state.
    #[error("`{name}` of `{kind}` is {value}, but must be {expected}")]
    OutOfRange {
        /// The generator.
        kind: String,
        /// Which value.
        name: &'static str,
        /// The value.
        value: String,
        /// What would be accepted.
        expected: &'static str,
    },
    /// All values are zero, which the map never leaves.
    #[error("the key of `{kind}` is all zero, a fixed point: make at least one value other than 0")]
    Zero {
        /// The generator.
        kind: String,
    },
    /// Both halves of the state of a wrapping cat map are even.
    #[error(
        "both values of `{kind}` are even ({a}, {b}), which shortens the period: make one of them odd"
    )]
    Even {
        /// The generator.
        kind: String,
        /// First value.
        a: u64,
        /// Second value.
        b: u64,
    },
    /// The second coordinate would repeat the first one, or mirror it.
    #[error(
        "the values {x} and {y} of `{kind}` are equal or mirrored, so that all points lie on a \
         diagonal: change one of them"
    )]
    Linked {
        /// The generator.
        kind: String,
        /// First value.
        x: String,
        /// Second value.
        y: String,
    },
    /// A value at, or a step or two before, a fixed point.
    #[error(
        "`{name}` of `{kind}` is {value}, which leads to a fixed point ({values}): choose a value \
         away from these"
    )]
    FixedPoint {
        /// The generator.
        kind: String,
        /// Which value.
        name: &'static str,
        /// The value.
        value: f64,
        /// The values that do so.
        values: &'static str,
    },
    /// The orbit repeats soon.
    #[error(
        "the key ({x}, {y}) of `{kind}` repeats after {period} steps, because its values are \
         multiples of a large power of 1/2: choose values with more digits, such as 0.4 and 0.644"
    )]
    ShortPeriod {
        /// The generator.
        kind: String,
        /// First value.
        x: f64,
        /// Second value.
        y: f64,
        /// Exact period (steps).
        period: u64,
    },
    /// The values stay so small that the map is not mixing for long.
    #[error(
        "the values ({x}, {y}) of `{kind}` are too small for the map to mix them within {steps} \
         steps: choose values above 1e-300"
    )]
    TooSmall {
        /// The generator.
        kind: String,
        /// First value.
        x: f64,
        /// Second value.
        y: f64,
        /// The steps tried.
        steps: u32,
    },
    /// A key of a generator that can be seen through, where a secret is wanted.
    #[error("`{kind}` keeps no secret; write `keyed:` and 64 hexadecimal digits")]
    NotSecret {
        /// The generator.
        kind: String,
    },
}

/// A key is the parameter `key` everywhere.
impl From<KeyError> for ParamsError {
    fn from(error: KeyError) -> Self {
        Self::refused("key", format!("`key`: {error}"))
    }
}
