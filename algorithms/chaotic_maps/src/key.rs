//! Keys: a generator and its initial state, as one line of text.

mod text;

use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha20Rng;

use crate::any_source::AnySource;
use crate::cat::{Cat64, CatF64, CatP};
use crate::chebyshev::{ChebF64, ChebP, Emission};
use crate::error::KeyError;
use crate::keyed::KeyedStream;
use crate::maps::{Logistic, Standard};
use crate::modulus::P;

/// A generator and its key.
///
/// As text, and in TOML and JSON, `kind:values`, such as `catp:0.4,0.644` or
/// `chebp-raw:123456789012345678,987654321098765432`. Parsing checks the form only; [`Key::validate`]
/// and [`Key::source`] reject keys that the generator cannot use.
#[derive(
    Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[serde(try_from = "String", into = "String")]
pub enum Key {
    /// `catp:a,b`: [`CatP`]; each value an integer or a decimal `0.ddd` of at most 19 digits.
    CatP {
        /// First half of the state.
        a: u64,
        /// Second half.
        b: u64,
    },
    /// `cat64:a,b`: [`Cat64`], integers.
    Cat64 {
        /// First half of the state.
        a: u64,
        /// Second half.
        b: u64,
    },
    /// `catf64:x,y`: [`CatF64`].
    CatF64 {
        /// Start, in [0, 1).
        x: f64,
        /// Start, in [0, 1).
        y: f64,
    },
    /// `chebp:tx,ty` (arcsine), `chebp-raw:…`: [`ChebP`], integers.
    ChebP {
        /// State of the first axis.
        tx: u64,
        /// State of the second axis.
        ty: u64,
        /// Output of the generator.
        emission: Emission,
    },
    /// `chebf64:x,y` (arcsine), `chebf64-raw:…`: [`ChebF64`].
    ChebF64 {
        /// Start, in [−1, 1].
        x: f64,
        /// Start, in [−1, 1].
        y: f64,
        /// Output of the generator.
        emission: Emission,
    },
    /// `logistic:x,y` (arcsine), `logistic-raw:…`: [`Logistic`].
    Logistic {
        /// Start, in (0, 1).
        x: f64,
        /// Start, in (0, 1).
        y: f64,
        /// Output of the generator.
        emission: Emission,
    },
    /// `standard:x,y` or `standard:x,y,k`: [`Standard`]; the default of `k` is 7.
    Standard {
        /// Start, in [0, 1).
        x: f64,
        /// Start, in [0, 1).
        y: f64,
        /// Parameter of the map.
        k: f64,
    },
    /// `keyed:` and 64 hexadecimal digits: [`KeyedStream`].
    Keyed {
        /// The secret.
        key: [u8; 32],
    },
}

/// The name of a generator: the part of a [`Key`] before the colon.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Hash,
    serde::Serialize,
    serde::Deserialize,
    schemars::JsonSchema,
)]
#[serde(try_from = "String", into = "String")]
pub enum KeyKind {
    /// `catp`
    CatP,
    /// `cat64`
    Cat64,
    /// `catf64`
    CatF64,
    /// `chebp`, `chebp-raw`
    ChebP(Emission),
    /// `chebf64`, `chebf64-raw`
    ChebF64(Emission),
    /// `logistic`, `logistic-raw`
    Logistic(Emission),
    /// `standard`
    Standard,
    /// `keyed`
    Keyed,
}

impl KeyKind {
    /// All kinds.
    pub const ALL: [Self; 11] = [
        Self::CatP,
        Self::Cat64,
        Self::CatF64,
        Self::ChebP(Emission::Arcsine),
        Self::ChebP(Emission::Raw),
        Self::ChebF64(Emission::Arcsine),
        Self::ChebF64(Emission::Raw),
        Self::Logistic(Emission::Arcsine),
        Self::Logistic(Emission::Raw),
        Self::Standard,
        Self::Keyed,
    ];
}

impl Key {
    /// The generator.
    pub const fn kind(&self) -> KeyKind {
        match *self {
            Self::CatP { .. } => KeyKind::CatP,
            Self::Cat64 { .. } => KeyKind::Cat64,
            Self::CatF64 { .. } => KeyKind::CatF64,
            Self::ChebP { emission, .. } => KeyKind::ChebP(emission),
            Self::ChebF64 { emission, .. } => KeyKind::ChebF64(emission),
            Self::Logistic { emission, .. } => KeyKind::Logistic(emission),
            Self::Standard { .. } => KeyKind::Standard,
            Self::Keyed { .. } => KeyKind::Keyed,
        }
    }

    /// Creates the generator in its initial state.
    ///
    /// # Errors
    /// [`KeyError`] for a key that the generator cannot use, with the remedy.
    pub fn source(&self) -> Result<AnySource, KeyError> {
        Ok(match *self {
            Self::CatP { a, b } => AnySource::CatP(CatP::new(a, b)?),
            Self::Cat64 { a, b } => AnySource::Cat64(Cat64::new(a, b)?),
            Self::CatF64 { x, y } => AnySource::CatF64(CatF64::new(x, y)?),
            Self::ChebP { tx, ty, emission } => AnySource::ChebP(ChebP::new(tx, ty, emission)?),
            Self::ChebF64 { x, y, emission } => AnySource::ChebF64(ChebF64::new(x, y, emission)?),
            Self::Logistic { x, y, emission } => {
                AnySource::Logistic(Logistic::new(x, y, emission)?)
            }
            Self::Standard { x, y, k } => AnySource::Standard(Standard::new(x, y, k)?),
            Self::Keyed { key } => AnySource::Keyed(Box::new(KeyedStream::new(key))),
        })
    }

    /// Checks that the generator can use the key.
    ///
    /// # Errors
    /// As [`Key::source`].
    pub fn validate(&self) -> Result<(), KeyError> {
        self.source().map(drop)
    }

    /// The bytes of the given secret, or of one derived from the seed of a run.
    ///
    /// # Errors
    /// [`KeyError::NotSecret`] if the given key is not one of [`KeyedStream`].
    pub fn secret(given: Option<Self>, seed: u64) -> Result<[u8; 32], KeyError> {
        match given.unwrap_or_else(|| Self::from_seed(KeyKind::Keyed, seed)) {
            Self::Keyed { key } => Ok(key),
            other => Err(KeyError::NotSecret {
                kind: other.kind().to_string(),
            }),
        }
    }

    /// A valid key of a kind from the seed of a run: the first one of a `ChaCha20` stream (one per
    /// kind) that is not degenerate.
    pub fn from_seed(kind: KeyKind, seed: u64) -> Self {
        let mut bytes = [0; 32];
        bytes[..8].copy_from_slice(&seed.to_le_bytes());
        // The name makes the streams of the kinds different.
        for (byte, letter) in bytes[8..].iter_mut().zip(kind.to_string().bytes()) {
            *byte = letter;
        }
        Self::first_valid(kind, ChaCha20Rng::from_seed(bytes))
    }

    /// The key of a robot of a team whose key this is: the same for number 0, and for each other number another one of
    /// the same kind. A holder of a [`Key::Keyed`] of another number learns nothing about those of the others.
    #[must_use]
    pub fn of_robot(&self, number: u64) -> Self {
        if number == 0 {
            return *self;
        }
        let mut bytes = [0; 32];
        match self {
            Self::Keyed { key } => bytes = *key,
            _ => {
                for (index, letter) in self.to_string().bytes().enumerate() {
                    bytes[index % 32] ^= letter;
                }
            }
        }
        let mut stream = ChaCha20Rng::from_seed(bytes);
        stream.set_stream(number);
        Self::first_valid(self.kind(), stream)
    }

    fn first_valid(kind: KeyKind, mut stream: ChaCha20Rng) -> Self {
        loop {
            let key = Self::draw(kind, &mut stream);
            if key.validate().is_ok() {
                return key;
            }
        }
    }

    /// The next candidate of a stream; most are valid.
    fn draw(kind: KeyKind, stream: &mut ChaCha20Rng) -> Self {
        let mut integer = || stream.next_u64();
        let unit = |bits: u64| (bits >> 11) as f64 / (1_u64 << 53) as f64;
        match kind {
            KeyKind::CatP => Self::CatP {
                a: integer() % P,
                b: integer() % P,
            },
            KeyKind::Cat64 => Self::Cat64 {
                a: integer(),
                b: integer(),
            },
            KeyKind::CatF64 => Self::CatF64 {
                x: unit(integer()),
                y: unit(integer()),
            },
            KeyKind::ChebP(emission) => Self::ChebP {
                tx: integer() % P,
                ty: integer() % P,
                emission,
            },
            KeyKind::ChebF64(emission) => Self::ChebF64 {
                x: 2.0 * unit(integer()) - 1.0,
                y: 2.0 * unit(integer()) - 1.0,
                emission,
            },
            KeyKind::Logistic(emission) => Self::Logistic {
                x: unit(integer()),
                y: unit(integer()),
                emission,
            },
            KeyKind::Standard => Self::Standard {
                x: unit(integer()),
                y: unit(integer()),
                k: Standard::K,
            },
            KeyKind::Keyed => {
                let mut key = [0; 32];
                stream.fill_bytes(&mut key);
                Self::Keyed { key }
            }
        }
    }
}

#[cfg(test)]
mod tests;
