//! The text of keys, both ways.

use core::fmt::{self, Display, Formatter};
use core::str::FromStr;

use super::{Key, KeyKind};
use crate::decimal::decimal_state;
use crate::error::KeyError;
use crate::maps::Standard;

impl Display for KeyKind {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match *self {
            Self::CatP => f.write_str("catp"),
            Self::Cat64 => f.write_str("cat64"),
            Self::CatF64 => f.write_str("catf64"),
            Self::ChebP(emission) => f.write_str(&emission.kind_of("chebp")),
            Self::ChebF64(emission) => f.write_str(&emission.kind_of("chebf64")),
            Self::Logistic(emission) => f.write_str(&emission.kind_of("logistic")),
            Self::Standard => f.write_str("standard"),
            Self::Keyed => f.write_str("keyed"),
        }
    }
}

impl FromStr for KeyKind {
    type Err = KeyError;

    fn from_str(text: &str) -> Result<Self, KeyError> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.to_string() == text)
            .ok_or_else(|| KeyError::KindName {
                found: text.chars().take(24).collect(),
            })
    }
}

impl Display for Key {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.kind())?;
        match self {
            Self::CatP { a, b } | Self::Cat64 { a, b } => write!(f, "{a},{b}"),
            Self::ChebP { tx, ty, .. } => write!(f, "{tx},{ty}"),
            // Rust prints the shortest decimal that parses to the same number.
            Self::CatF64 { x, y } | Self::ChebF64 { x, y, .. } | Self::Logistic { x, y, .. } => {
                write!(f, "{x},{y}")
            }
            Self::Standard { x, y, k } if *k == Standard::K => write!(f, "{x},{y}"),
            Self::Standard { x, y, k } => write!(f, "{x},{y},{k}"),
            Self::Keyed { key } => key.iter().try_for_each(|byte| write!(f, "{byte:02x}")),
        }
    }
}

impl FromStr for Key {
    type Err = KeyError;

    fn from_str(text: &str) -> Result<Self, KeyError> {
        let (kind, rest) = text.split_once(':').ok_or_else(|| KeyError::Kind {
            found: text.chars().take(24).collect(),
        })?;
        let kind: KeyKind = kind.trim().parse().map_err(|_| KeyError::Kind {
            found: kind.trim().chars().take(24).collect(),
        })?;
        let values = Values {
            kind,
            text: rest.trim(),
        };
        Ok(match kind {
            KeyKind::CatP => {
                let [a, b] = values.pair(|text| {
                    if text.contains('.') {
                        decimal_state(text)
                    } else {
                        values.integer(text)
                    }
                })?;
                Self::CatP { a, b }
            }
            KeyKind::Cat64 => {
                let [a, b] = values.pair(|text| values.integer(text))?;
                Self::Cat64 { a, b }
            }
            KeyKind::ChebP(emission) => {
                let [tx, ty] = values.pair(|text| values.integer(text))?;
                Self::ChebP { tx, ty, emission }
            }
            KeyKind::CatF64 => {
                let [x, y] = values.numbers()?;
                Self::CatF64 { x, y }
            }
            KeyKind::ChebF64(emission) => {
                let [x, y] = values.numbers()?;
                Self::ChebF64 { x, y, emission }
            }
            KeyKind::Logistic(emission) => {
                let [x, y] = values.numbers()?;
                Self::Logistic { x, y, emission }
            }
            KeyKind::Standard => values.standard()?,
            KeyKind::Keyed => Self::Keyed {
                key: hex(values.text)?,
            },
        })
    }
}

/// The part after the colon.
struct Values<'a> {
    kind: KeyKind,
    text: &'a str,
}

impl Values<'_> {
    fn parts(&self) -> Vec<&str> {
        self.text.split(',').map(str::trim).collect()
    }

    fn count(&self, expected: &'static str, count: usize) -> KeyError {
        KeyError::Count {
            kind: self.kind.to_string(),
            expected,
            found: self.text.to_owned(),
            count,
        }
    }

    fn pair<T>(&self, read: impl Fn(&str) -> Result<T, KeyError>) -> Result<[T; 2], KeyError> {
        match self.parts()[..] {
            [first, second] => Ok([read(first)?, read(second)?]),
            ref parts => Err(self.count("two values", parts.len())),
        }
    }

    fn integer(&self, text: &str) -> Result<u64, KeyError> {
        text.parse().map_err(|_| KeyError::Integer {
            kind: self.kind.to_string(),
            found: text.to_owned(),
        })
    }

    fn number(&self, text: &str) -> Result<f64, KeyError> {
        text.parse().map_err(|_| KeyError::Number {
            kind: self.kind.to_string(),
            found: text.to_owned(),
        })
    }

    fn numbers(&self) -> Result<[f64; 2], KeyError> {
        self.pair(|text| self.number(text))
    }

    fn standard(&self) -> Result<Key, KeyError> {
        let (x, y, k) = match self.parts()[..] {
            [x, y] => (self.number(x)?, self.number(y)?, Standard::K),
            [x, y, k] => (self.number(x)?, self.number(y)?, self.number(k)?),
            ref parts => return Err(self.count("two or three values", parts.len())),
        };
        Ok(Key::Standard { x, y, k })
    }
}

fn hex(text: &str) -> Result<[u8; 32], KeyError> {
    let refusal = || KeyError::Hex {
        length: text.chars().count(),
    };
    let digits: Vec<u8> = text
        .chars()
        .map(|c| c.to_digit(16).map(|digit| digit as u8))
        .collect::<Option<_>>()
        .ok_or_else(refusal)?;
    let bytes: Vec<u8> = digits
        .chunks(2)
        .map(|pair| pair.iter().fold(0, |byte, digit| byte << 4 | digit))
        .collect();
    if digits.len() == 64 {
        bytes.try_into().map_err(|_| refusal())
    } else {
        Err(refusal())
    }
}

/// Serialises and deserialises the same text with Serde.
macro_rules! as_text {
    ($type:ty) => {
        impl TryFrom<String> for $type {
            type Error = KeyError;

            fn try_from(text: String) -> Result<Self, KeyError> {
                text.parse()
            }
        }

        impl From<$type> for String {
            fn from(value: $type) -> Self {
                value.to_string()
            }
        }
    };
}

as_text!(Key);
as_text!(KeyKind);
