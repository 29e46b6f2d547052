//! One type for any of the generators.

use crate::cat::{Cat64, CatF64, CatP};
use crate::chebyshev::{ChebF64, ChebP};
use crate::keyed::KeyedStream;
use crate::maps::{Logistic, Standard};
use crate::source::Source;

/// Any of the generators.
#[derive(Debug, Clone)]
pub enum AnySource {
    /// Cat map modulo 2⁶³ − 25.
    CatP(CatP),
    /// Cat map modulo 2⁶⁴.
    Cat64(Cat64),
    /// Cat map in `f64`.
    CatF64(CatF64),
    /// Chebyshev map modulo 2⁶³ − 25.
    ChebP(ChebP),
    /// Chebyshev map in `f64`.
    ChebF64(ChebF64),
    /// Logistic maps.
    Logistic(Logistic),
    /// Standard map.
    Standard(Standard),
    /// Keyed stream (boxed: it holds a buffer many times the size of the others).
    Keyed(Box<KeyedStream>),
}

impl AnySource {
    /// Skips `steps` points: at once where the arithmetic is exact, one by one for the maps in
    /// `f64` (except the cat map, which is exact once on its grid).
    pub fn advance(&mut self, steps: u64) {
        match self {
            Self::CatP(source) => source.advance(steps),
            Self::Cat64(source) => source.advance(steps),
            Self::CatF64(source) => source.advance(steps),
            Self::ChebP(source) => source.advance(steps),
            Self::Keyed(source) => source.advance(steps),
            Self::ChebF64(_) | Self::Logistic(_) | Self::Standard(_) => {
                for _ in 0..steps {
                    self.next_unit();
                }
            }
        }
    }
}

/// Calls a method of the contained generator.
macro_rules! each {
    ($any:expr, $source:ident => $call:expr) => {
        match $any {
            AnySource::CatP($source) => $call,
            AnySource::Cat64($source) => $call,
            AnySource::CatF64($source) => $call,
            AnySource::ChebP($source) => $call,
            AnySource::ChebF64($source) => $call,
            AnySource::Logistic($source) => $call,
            AnySource::Standard($source) => $call,
            AnySource::Keyed($source) => $call,
        }
    };
}

impl Source for AnySource {
    fn next_unit(&mut self) -> [f64; 2] {
        each!(self, source => source.next_unit())
    }

    fn next_symmetric(&mut self) -> [f64; 2] {
        each!(self, source => source.next_symmetric())
    }
}
