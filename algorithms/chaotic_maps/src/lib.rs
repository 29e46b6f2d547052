//! Keys and generators of points in the unit square: chaotic maps with integer state, the papers'
//! floating-point forms of them, and a keyed stream against observers that know the method.
//!
//! - [`key::Key`] names a generator and its key in one line of text; [`Key::source`] starts it.
//! - [`cat`]: Arnold's cat map modulo a prime, modulo 2⁶⁴, and in `f64` as in the paper;
//! - [`chebyshev`]: the Chebyshev map of degree 6, exact and in `f64`;
//! - [`maps`]: logistic and standard map, drop-in sources of the coverage papers;
//! - [`keyed`]: a `ChaCha20` stream;
//!
//! None of the chaotic maps keeps a secret: each is public, and the cat and Chebyshev maps are
//! linear, so that fewer than a hundred points determine their state. Only [`keyed::KeyedStream`]
//! protects against an observer that knows the method.
//!
//! ```
//! use chaotic_maps::{Key, Source as _};
//!
//! let key: Key = "catp:0.4,0.644".parse()?;
//! let mut points = key.source()?;
//! let [x, y] = points.next_unit();
//! assert!((0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y));
//! // The same key gives the same points.
//! assert_eq!(key.source()?.next_unit(), [x, y]);
//! # Ok::<(), chaotic_maps::KeyError>(())
//! ```

mod any_source;
pub mod cat;
pub mod chebyshev;
mod decimal;
mod error;
pub mod key;
pub mod keyed;
pub mod maps;
pub mod modulus;
mod source;

pub use any_source::AnySource;
pub use cat::{Cat64, CatF64, CatP};
pub use chebyshev::{ChebF64, ChebP, Emission};
pub use error::KeyError;
pub use key::{Key, KeyKind};
pub use keyed::KeyedStream;
pub use maps::{Logistic, Standard};
pub use source::Source;
