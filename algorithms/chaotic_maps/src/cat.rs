//! Arnold's cat map `(a, b) ← (a + b, a + 2b)` on three rings (cat-map patrol paper, Eq. 1).
//!
//! The forms differ in their arithmetic only. [`CatP`] is recommended: every key but zero has the
//! full period `P + 1`. [`Cat64`] is the fastest; its low bits have short periods and are not used.
//! [`CatF64`] is the paper's form: after a few steps rounding makes it the same map on the grid of
//! 2⁻⁵¹. The map is linear; `recovery` of the observer uses this.

use crate::error::KeyError;
use crate::modulus::{P, add, mul};
use crate::source::Source;

/// 2⁻⁵³, the distance of the outputs of the exact forms.
const ULP: f64 = 1.0 / (1_u64 << 53) as f64;

/// The cat map modulo the prime [`P`]; period `P + 1` for every key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CatP {
    a: u64,
    b: u64,
}

impl CatP {
    /// Starts from a state.
    ///
    /// # Errors
    /// [`KeyError`] when a value is not below [`P`] or both are zero.
    pub fn new(a: u64, b: u64) -> Result<Self, KeyError> {
        for (name, value) in [("a", a), ("b", b)] {
            if value >= P {
                return Err(KeyError::OutOfRange {
                    kind: "catp".to_owned(),
                    name,
                    value: value.to_string(),
                    expected: "below 2^63 - 25 = 9223372036854775783",
                });
            }
        }
        if (a, b) == (0, 0) {
            return Err(KeyError::Zero {
                kind: "catp".to_owned(),
            });
        }
        Ok(Self { a, b })
    }

    /// The state `(a, b)`.
    pub const fn state(&self) -> (u64, u64) {
        (self.a, self.b)
    }

    /// One step.
    #[inline]
    pub const fn step(&mut self) {
        self.a = add(self.a, self.b);
        self.b = add(self.a, self.b);
    }

    /// One step back: the inverse `(2a − b, b − a)`.
    pub const fn step_back(&mut self) {
        self.b = crate::modulus::sub(self.b, self.a);
        self.a = crate::modulus::sub(self.a, self.b);
    }

    /// The point of the current state, each coordinate in [0, 1).
    #[inline]
    pub const fn point(&self) -> [f64; 2] {
        [(self.a >> 10) as f64 * ULP, (self.b >> 10) as f64 * ULP]
    }

    /// Takes `steps` steps at once, in time logarithmic in their number.
    pub const fn advance(&mut self, steps: u64) {
        // The powers of a symmetric matrix with trace 3 are ((p, q), (q, p + q)).
        let (mut p, mut q) = (1, 1);
        let mut rest = steps;
        while rest > 0 {
            if rest & 1 == 1 {
                (self.a, self.b) = (
                    add(mul(p, self.a), mul(q, self.b)),
                    add(mul(q, self.a), mul(add(p, q), self.b)),
                );
            }
            let qq = mul(q, q);
            (p, q) = (add(mul(p, p), qq), add(mul(add(p, p), q), qq));
            rest >>= 1;
        }
    }
}

impl Source for CatP {
    #[inline]
    fn next_unit(&mut self) -> [f64; 2] {
        self.step();
        self.point()
    }
}

/// The cat map modulo 2⁶⁴; period 3·2⁶² when `a` or `b` is odd.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cat64 {
    a: u64,
    b: u64,
}

impl Cat64 {
    /// Starts from a state.
    ///
    /// # Errors
    /// [`KeyError`] when both values are even.
    pub fn new(a: u64, b: u64) -> Result<Self, KeyError> {
        let kind = || "cat64".to_owned();
        if (a, b) == (0, 0) {
            Err(KeyError::Zero { kind: kind() })
        } else if (a | b) & 1 == 0 {
            Err(KeyError::Even { kind: kind(), a, b })
        } else {
            Ok(Self { a, b })
        }
    }

    /// The state `(a, b)`.
    pub const fn state(&self) -> (u64, u64) {
        (self.a, self.b)
    }

    /// One step.
    #[inline]
    pub const fn step(&mut self) {
        self.a = self.a.wrapping_add(self.b);
        self.b = self.a.wrapping_add(self.b);
    }

    /// One step back.
    pub const fn step_back(&mut self) {
        self.b = self.b.wrapping_sub(self.a);
        self.a = self.a.wrapping_sub(self.b);
    }

    /// The point of the current state, each coordinate in [0, 1).
    #[inline]
    pub const fn point(&self) -> [f64; 2] {
        [(self.a >> 11) as f64 * ULP, (self.b >> 11) as f64 * ULP]
    }

    /// Takes `steps` steps at once, in time logarithmic in their number.
    pub const fn advance(&mut self, steps: u64) {
        (self.a, self.b) = advance_wrapping((self.a, self.b), steps);
    }
}

impl Source for Cat64 {
    #[inline]
    fn next_unit(&mut self) -> [f64; 2] {
        self.step();
        self.point()
    }
}

/// The state `(a, b)` after `steps` steps modulo 2⁶⁴ (and, as that divides it, any power of two).
pub(crate) const fn advance_wrapping((mut a, mut b): (u64, u64), steps: u64) -> (u64, u64) {
    let (mut p, mut q) = (1_u64, 1_u64);
    let mut rest = steps;
    while rest > 0 {
        if rest & 1 == 1 {
            (a, b) = (
                p.wrapping_mul(a).wrapping_add(q.wrapping_mul(b)),
                q.wrapping_mul(a)
                    .wrapping_add(p.wrapping_add(q).wrapping_mul(b)),
            );
        }
        let qq = q.wrapping_mul(q);
        (p, q) = (
            p.wrapping_mul(p).wrapping_add(qq),
            p.wrapping_mul(2).wrapping_mul(q).wrapping_add(qq),
        );
        rest >>= 1;
    }
    (a, b)
}

/// The cat map in `f64`, in the paper's order of evaluation: `x' = {x + y}`, `y' = {x + 2y}`.
///
/// The order is part of the definition: `{x' + y}` gives another orbit after some 38 steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CatF64 {
    x: f64,
    y: f64,
}

/// Bits of the grid on which the orbits of [`CatF64`] end: the sum `x + 2y` in [2, 3) has no finer
/// ones.
pub const F64_GRID_BITS: u32 = 51;

/// Steps within which an orbit of [`CatF64`] must be on its grid. Random keys need some 5, the
/// smallest positive numbers 800.
const GRID_STEPS: u32 = 10_000;

/// Minimum number of bits of the grid in use: with 32 the period is 3·2³⁰ steps, a century at one
/// step per second.
const MIN_GRID_BITS: u32 = 32;

impl CatF64 {
    /// Starts from a point of the unit square.
    ///
    /// The orbit reaches the grid of 2⁻⁵¹ after a few steps and is from there on the integer map
    /// modulo 2⁵¹. Where both integers are multiples of 2ᵏ, it is the map modulo 2⁵¹⁻ᵏ, whose period
    /// is 3·2⁴⁹⁻ᵏ. Keys with fewer than 32 remaining bits are rejected.
    ///
    /// # Errors
    /// [`KeyError`] when a value is not in [0, 1), when both are zero, or when the period is short.
    pub fn new(x: f64, y: f64) -> Result<Self, KeyError> {
        let kind = || "catf64".to_owned();
        for (name, value) in [("x", x), ("y", y)] {
            if !(0.0..1.0).contains(&value) {
                return Err(KeyError::OutOfRange {
                    kind: kind(),
                    name,
                    value: value.to_string(),
                    expected: "at least 0 and below 1",
                });
            }
        }
        if (x, y) == (0.0, 0.0) {
            return Err(KeyError::Zero { kind: kind() });
        }
        let start = Self { x, y };
        let mut ahead = start;
        for _ in 0..GRID_STEPS {
            if let Some((a, b)) = ahead.grid() {
                let shared = (a | b).trailing_zeros().min(F64_GRID_BITS);
                let bits = F64_GRID_BITS - shared;
                return if bits >= MIN_GRID_BITS {
                    Ok(start)
                } else {
                    Err(KeyError::ShortPeriod {
                        kind: kind(),
                        x,
                        y,
                        period: period_modulo_power_of_two(bits),
                    })
                };
            }
            ahead.step();
        }
        Err(KeyError::TooSmall {
            kind: kind(),
            x,
            y,
            steps: GRID_STEPS,
        })
    }

    /// The state as integers in units of 2⁻⁵¹, once it is on that grid.
    pub fn grid(&self) -> Option<(u64, u64)> {
        let scale = (1_u64 << F64_GRID_BITS) as f64;
        let (a, b) = (self.x * scale, self.y * scale);
        (a.floor() == a && b.floor() == b).then_some((a as u64, b as u64))
    }

    /// The state `(x, y)`.
    pub const fn state(&self) -> (f64, f64) {
        (self.x, self.y)
    }

    /// One step.
    #[inline]
    pub fn step(&mut self) {
        let (sum, double) = (self.x + self.y, self.x + 2.0 * self.y);
        self.x = sum - sum.floor();
        self.y = double - double.floor();
    }

    /// Takes `steps` steps: one by one until the grid is reached, the others at once.
    pub fn advance(&mut self, mut steps: u64) {
        let scale = (1_u64 << F64_GRID_BITS) as f64;
        let mask = (1_u64 << F64_GRID_BITS) - 1;
        while steps > 0 {
            if let Some(state) = self.grid() {
                let (a, b) = advance_wrapping(state, steps);
                (self.x, self.y) = ((a & mask) as f64 / scale, (b & mask) as f64 / scale);
                return;
            }
            self.step();
            steps -= 1;
        }
    }
}

/// Period of the cat map modulo 2ᵏ for a state with one odd half: 3·2ᵏ⁻² for k ≥ 2.
const fn period_modulo_power_of_two(bits: u32) -> u64 {
    match bits {
        0 => 1,
        1 => 3,
        _ => 3 << (bits - 2),
    }
}

impl Source for CatF64 {
    #[inline]
    fn next_unit(&mut self) -> [f64; 2] {
        self.step();
        [self.x, self.y]
    }
}

#[cfg(test)]
mod tests;
