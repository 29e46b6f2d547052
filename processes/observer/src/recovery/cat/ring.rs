//! States of a cat map as integers on a ring.

use super::history::ObservedPoint;
use chaotic_maps::AnySource;
use chaotic_maps::cat::{Cat64, CatF64, CatP, F64_GRID_BITS};
use chaotic_maps::modulus::{P, add, sub};

/// The ring of the integers of a cat map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CatModulus {
    /// 2⁵¹, on which [`CatF64`] ends up.
    F64,
    /// 2⁶⁴, of [`Cat64`].
    Wrapping64,
    /// The prime of [`CatP`].
    Prime,
}

/// Fractional bits of the sums below.
pub const FRACTION: u32 = 120;

/// A state on the ring.
#[derive(Clone, Copy)]
pub struct State {
    pub(super) a: u64,
    pub(super) b: u64,
    pub(super) modulus: CatModulus,
}

impl CatModulus {
    pub(super) const fn bits(self) -> u32 {
        match self {
            Self::F64 => F64_GRID_BITS,
            Self::Wrapping64 => 64,
            Self::Prime => 63,
        }
    }

    /// Returns the integer closest to `fraction` (in units of 2⁻¹²⁰) of the modulus, on the ring.
    pub(super) fn round(self, fraction: i128) -> u64 {
        let fraction = fraction.rem_euclid(1 << FRACTION);
        let fraction = match self {
            Self::F64 | Self::Wrapping64 => fraction,
            // 2⁶³ − 25 = 2⁶³ (1 − 25·2⁻⁶³).
            Self::Prime => fraction - ((25 * fraction) >> 63),
        };
        let shift = FRACTION - self.bits();
        let integer = (fraction + (1 << (shift - 1))) >> shift;
        let size = match self {
            Self::F64 | Self::Wrapping64 => 1 << self.bits(),
            Self::Prime => i128::from(P),
        };
        integer.rem_euclid(size) as u64
    }
}

impl State {
    pub(super) fn step(&mut self) {
        match self.modulus {
            CatModulus::Prime => {
                self.a = add(self.a, self.b);
                self.b = add(self.a, self.b);
            }
            CatModulus::F64 | CatModulus::Wrapping64 => {
                self.a = self.masked(self.a.wrapping_add(self.b));
                self.b = self.masked(self.a.wrapping_add(self.b));
            }
        }
    }

    pub(super) fn step_back(&mut self) {
        match self.modulus {
            CatModulus::Prime => {
                self.b = sub(self.b, self.a);
                self.a = sub(self.a, self.b);
            }
            CatModulus::F64 | CatModulus::Wrapping64 => {
                self.b = self.masked(self.b.wrapping_sub(self.a));
                self.a = self.masked(self.a.wrapping_sub(self.b));
            }
        }
    }

    fn masked(&self, value: u64) -> u64 {
        value & (u64::MAX >> (64 - self.modulus.bits()))
    }

    /// Returns `true` if an observation is close to the state, on the torus.
    pub(super) fn agrees(&self, seen: &ObservedPoint) -> bool {
        let scale = (1_u128 << self.modulus.bits()) as f64;
        seen.close([self.a as f64 / scale, self.b as f64 / scale])
    }

    /// Returns the generator in this state; none for states without a key.
    pub(super) fn source(&self) -> Option<AnySource> {
        match self.modulus {
            CatModulus::Prime => CatP::new(self.a, self.b).ok().map(AnySource::CatP),
            CatModulus::Wrapping64 => Cat64::new(self.a, self.b).ok().map(AnySource::Cat64),
            CatModulus::F64 => {
                let scale = (1_u64 << F64_GRID_BITS) as f64;
                CatF64::new(self.a as f64 / scale, self.b as f64 / scale)
                    .ok()
                    .map(AnySource::CatF64)
            }
        }
    }
}
