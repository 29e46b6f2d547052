//! The Chebyshev map of degree 6, `x' = cos(6·acos x)`, one independent map per axis (Chebyshev
//! coverage paper, Eq. 8 with k = 6).
//!
//! The paper's transform (its Eq. 4 and 5) is applied to the emitted copy only. Applied to the
//! state, as its Eq. 9 and 11 are printed, it would change the map: the points would not be
//! uniform, and some orbits end in a corner.

use core::f64::consts::{FRAC_2_PI, TAU};

use crate::error::KeyError;
use crate::modulus::{P, add, mul, pow};
use crate::source::{Source, symmetric_to_unit};

/// Output of a map with the arcsine law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Emission {
    /// The state itself: dense at the edges.
    Raw,
    /// `2·asin(x)/π` (coverage paper, Eq. 4): uniform. (Its Eq. 5, with acos, is the mirror image.)
    #[default]
    Arcsine,
}

impl Emission {
    /// The name of a generator: the name of its map with the suffix of the emission.
    pub(crate) fn kind_of(self, map: &str) -> String {
        match self {
            Self::Raw => format!("{map}-raw"),
            Self::Arcsine => map.to_owned(),
        }
    }

    /// Transforms a value of [−1, 1] with the arcsine law.
    pub(crate) fn emit(self, x: f64) -> f64 {
        match self {
            Self::Raw => x,
            Self::Arcsine => FRAC_2_PI * libm::asin(x),
        }
    }
}

/// The Chebyshev map in exact arithmetic: with `x = cos(2πt/P)` it is `t ← 6t mod P`.
///
/// As 6 is a primitive root of [`P`], `t` has the period `P − 1` and the point (which is equal for
/// `t` and `P − t`) half of that. In `f64` the same triangular wave would collapse, as 6 is even.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChebP {
    tx: u64,
    ty: u64,
    emission: Emission,
}

/// `6t` modulo [`P`].
#[inline]
const fn six(t: u64) -> u64 {
    let triple = add(add(t, t), t);
    add(triple, triple)
}

impl ChebP {
    /// Starts from a state.
    ///
    /// # Errors
    /// [`KeyError`] when a value is 0 or not below [`P`], or when `tx = ±ty` modulo [`P`].
    pub fn new(tx: u64, ty: u64, emission: Emission) -> Result<Self, KeyError> {
        let kind = || emission.kind_of("chebp");
        for (name, value) in [("tx", tx), ("ty", ty)] {
            if value == 0 || value >= P {
                return Err(KeyError::OutOfRange {
                    kind: kind(),
                    name,
                    value: value.to_string(),
                    expected: "above 0 and below 2^63 - 25 = 9223372036854775783",
                });
            }
        }
        if tx == ty || tx == P - ty {
            return Err(KeyError::Linked {
                kind: kind(),
                x: tx.to_string(),
                y: ty.to_string(),
            });
        }
        Ok(Self { tx, ty, emission })
    }

    /// The state `(tx, ty)`.
    pub const fn state(&self) -> (u64, u64) {
        (self.tx, self.ty)
    }

    /// One step.
    #[inline]
    pub const fn step(&mut self) {
        self.tx = six(self.tx);
        self.ty = six(self.ty);
    }

    /// The point of the current state, each coordinate in [−1, 1].
    #[inline]
    pub fn point(&self) -> [f64; 2] {
        [self.tx, self.ty].map(|t| match self.emission {
            Emission::Raw => libm::cos(TAU * (t as f64 / P as f64)),
            Emission::Arcsine => arcsine(t),
        })
    }

    /// Takes `steps` steps at once, in time logarithmic in their number.
    pub const fn advance(&mut self, steps: u64) {
        let factor = pow(6, steps);
        self.tx = mul(self.tx, factor);
        self.ty = mul(self.ty, factor);
    }
}

/// `2·asin(cos(2πt/P))/π`, with no rounding except that of the division.
#[inline]
pub(crate) fn arcsine(t: u64) -> f64 {
    1.0 - 4.0 * (t.min(P - t) as f64 / P as f64)
}

impl Source for ChebP {
    #[inline]
    fn next_unit(&mut self) -> [f64; 2] {
        symmetric_to_unit(self.next_symmetric())
    }

    #[inline]
    fn next_symmetric(&mut self) -> [f64; 2] {
        self.step();
        self.point()
    }
}

/// The Chebyshev map of the paper, in `f64`.
///
/// For reproduction only: from some index on, all keys share a few cycles (the longest known has 27
/// 042 774 points), and the rounding errors reach 0.1 after some twenty steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChebF64 {
    x: f64,
    y: f64,
    emission: Emission,
}

/// Distance within which a value counts as equal to one that leads to a fixed point, or to the
/// other value.
const TOLERANCE: f64 = 1e-9;

impl ChebF64 {
    /// Starts from a point of the square [−1, 1]².
    ///
    /// # Errors
    /// [`KeyError`] when a value is outside, when its size is within 1e-9 of 0, 1/2, √3/2 or 1 (at
    /// a fixed point after two steps), or when `y = ±x`.
    pub fn new(x: f64, y: f64, emission: Emission) -> Result<Self, KeyError> {
        let kind = || emission.kind_of("chebf64");
        for (name, value) in [("x", x), ("y", y)] {
            if !(-1.0..=1.0).contains(&value) {
                return Err(KeyError::OutOfRange {
                    kind: kind(),
                    name,
                    value: value.to_string(),
                    expected: "between -1 and 1",
                });
            }
            if [0.0, 0.5, 0.75_f64.sqrt(), 1.0]
                .iter()
                .any(|special| (value.abs() - special).abs() <= TOLERANCE)
            {
                return Err(KeyError::FixedPoint {
                    kind: kind(),
                    name,
                    value,
                    values: "0, 1/2, sqrt(3)/2 and 1, of either sign",
                });
            }
        }
        if (x.abs() - y.abs()).abs() <= TOLERANCE {
            return Err(KeyError::Linked {
                kind: kind(),
                x: x.to_string(),
                y: y.to_string(),
            });
        }
        Ok(Self { x, y, emission })
    }

    /// The state `(x, y)`.
    pub const fn state(&self) -> (f64, f64) {
        (self.x, self.y)
    }

    /// The point of the current state, each coordinate in [−1, 1].
    pub fn point(&self) -> [f64; 2] {
        [self.x, self.y].map(|c| self.emission.emit(c))
    }

    /// One step.
    pub fn step(&mut self) {
        self.x = chebyshev(self.x);
        self.y = chebyshev(self.y);
    }
}

/// `cos(6·acos x)`, with `x` clamped to the domain of the arccosine.
fn chebyshev(x: f64) -> f64 {
    libm::cos(6.0 * libm::acos(x.clamp(-1.0, 1.0)))
}

impl Source for ChebF64 {
    fn next_unit(&mut self) -> [f64; 2] {
        symmetric_to_unit(self.next_symmetric())
    }

    fn next_symmetric(&mut self) -> [f64; 2] {
        self.step();
        self.point()
    }
}

#[cfg(test)]
mod tests;
