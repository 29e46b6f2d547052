//! The state of a cat map from noisy points.
//!
//! Consecutive points tell the integers `k_j` by which the map was wrapped,
//! `k_j = M z_j − z_{j+1}`, as long as the noise is well below 1/8. Along the direction in which the
//! map expands (by φ² = 2.618), the wraps to come fix a state in the middle of the window ever more
//! precisely; along the one in which it contracts, the wraps before do. As soon as both are known
//! better than the spacing of the integers, rounding gives the state.

use std::collections::VecDeque;

use super::Tracked;
use crate::cat::{Cat64, CatF64, CatP, F64_GRID_BITS};
use crate::modulus::{P, add, sub};
use crate::source::AnySource;

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

/// Observations at the start and at the end of a window that take no part in the estimate.
const CHECKED_BEFORE: usize = 3;
const CHECKED_AFTER: usize = 5;

/// Observations kept; with more, the first of them would add nothing.
const MAX_WINDOW: usize = 112;

/// Largest distance of `M z_j − z_{j+1}` from whole numbers. Six standard deviations at a noise of
/// 2 %; half of all unrelated pairs of points are further away.
const MAX_RESIDUAL: f64 = 0.35;

/// Largest distance of an observed coordinate from that of a claimed orbit.
const TOLERANCE: f64 = 0.15;

/// Bits behind the point in the sums below.
const FRACTION: u32 = 120;

/// `φ⁻ʲ/√5` for `j` from −1 on, in units of 2⁻¹²⁰.
///
/// It is `F(180 − j)/L(180)` with Fibonacci and Lucas numbers up to a relative error below 2⁻⁶⁸ at
/// the end of the table and 2⁻²⁴⁰ at its start, which keeps the integers in 128 bits.
static POWERS: [i128; MAX_WINDOW + 4] = powers();

const fn powers() -> [i128; MAX_WINDOW + 4] {
    let mut fibonacci = [0_u128; 182];
    fibonacci[1] = 1;
    let mut i = 2;
    while i < fibonacci.len() {
        fibonacci[i] = fibonacci[i - 1] + fibonacci[i - 2];
        i += 1;
    }
    let lucas = fibonacci[181] + fibonacci[179];
    let mut table = [0; MAX_WINDOW + 4];
    let mut j = 0;
    while j < table.len() {
        // Long division, a bit at a time; the numerator is below the denominator.
        let (mut rest, mut quotient, mut bit) = (fibonacci[181 - j], 0_u128, 0);
        while bit < FRACTION {
            rest *= 2;
            quotient *= 2;
            if rest >= lucas {
                rest -= lucas;
                quotient += 1;
            }
            bit += 1;
        }
        table[j] = quotient as i128;
        j += 1;
    }
    table
}

/// A state on the ring.
#[derive(Clone, Copy)]
struct State {
    a: u64,
    b: u64,
    modulus: CatModulus,
}

impl CatModulus {
    const fn bits(self) -> u32 {
        match self {
            Self::F64 => F64_GRID_BITS,
            Self::Wrapping64 => 64,
            Self::Prime => 63,
        }
    }

    /// The integer closest to `fraction` (in units of 2⁻¹²⁰) of the modulus, on the ring.
    fn round(self, fraction: i128) -> u64 {
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
    fn step(&mut self) {
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

    fn step_back(&mut self) {
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

    /// Whether an observation is close to the state, on the torus.
    fn agrees(&self, observed: [f64; 2]) -> bool {
        let scale = (1_u128 << self.modulus.bits()) as f64;
        close(observed, [self.a as f64 / scale, self.b as f64 / scale])
    }

    /// The generator in this state; none for states that no key leads to.
    fn source(&self) -> Option<AnySource> {
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

/// Whether two points of the torus are within the tolerance, by coordinate.
fn close(one: [f64; 2], other: [f64; 2]) -> bool {
    one.iter().zip(other).all(|(a, b)| {
        let difference = a - b;
        (difference - difference.round()).abs() <= TOLERANCE
    })
}

/// Recovers the state of a cat map from consecutive noisy points.
///
/// Needs 77 points modulo 2⁵¹ (counted from where the `f64` orbit is on its grid), 95 modulo the
/// prime and 97 modulo 2⁶⁴, and with a noise of 2 % of the side a few more.
#[derive(Debug, Clone)]
pub struct CatRecovery {
    modulus: CatModulus,
    window: VecDeque<[f64; 2]>,
    found: Option<Tracked>,
}

impl CatRecovery {
    /// An observer who knows the modulus and has seen nothing.
    pub fn new(modulus: CatModulus) -> Self {
        Self {
            modulus,
            window: VecDeque::with_capacity(MAX_WINDOW),
            found: None,
        }
    }

    /// Takes the next point as observed, in units of the square; noise may carry it outside.
    ///
    /// Non-finite numbers count as a [`CatRecovery::gap`].
    pub fn observe(&mut self, point: [f64; 2]) {
        if !point.iter().all(|c| c.is_finite()) {
            self.gap();
            return;
        }
        if let Some(found) = &mut self.found {
            if found.follow(|symmetric| close(point, symmetric.map(|c| 0.5 * (c + 1.0)))) {
                return;
            }
            self.forget();
        }
        if self
            .window
            .back()
            .is_some_and(|&last| wraps(last, point).is_none())
        {
            self.window.clear();
        }
        if self.window.len() == MAX_WINDOW {
            self.window.pop_front();
        }
        self.window.push_back(point);
        self.found = self
            .recover()
            .and_then(|state| state.source())
            .map(Tracked::new);
    }

    /// Says that the next point was not seen.
    ///
    /// A recovered orbit goes on; otherwise the collection starts over.
    pub fn gap(&mut self) {
        match &mut self.found {
            Some(found) => {
                found.follow(|_| true);
            }
            None => self.window.clear(),
        }
    }

    /// Starts over, for when it is not known how many points were missed.
    pub fn forget(&mut self) {
        self.window.clear();
        self.found = None;
    }

    /// The generator, once recovered and verified; its next point is the next one to be observed.
    pub fn state(&self) -> Option<&AnySource> {
        self.found.as_ref().map(|found| &found.source)
    }

    /// The last state of the window, if the window suffices and an exact orbit runs through all of
    /// it.
    fn recover(&self) -> Option<State> {
        let points = &self.window;
        let first = CHECKED_BEFORE;
        let last = points.len().checked_sub(1 + CHECKED_AFTER)?;
        let middle = usize::midpoint(first, last);
        // Each step on either side is worth log₂ φ² = 1.388 bits, and the noisy points at the ends
        // some four.
        let bits = 1.388 * middle.checked_sub(first)? as f64;
        if bits < f64::from(self.modulus.bits()) - 4.0 {
            return None;
        }
        let start = self.estimate(first, middle, last)?;
        let mut state = start;
        for &point in points.range(..middle).rev() {
            state.step_back();
            if !state.agrees(point) {
                return None;
            }
        }
        state = start;
        for &point in points.range(middle + 1..) {
            state.step();
            if !state.agrees(point) {
                return None;
            }
        }
        Some(state)
    }

    /// The state at `middle` from the wraps between `first` and `last`.
    ///
    /// With `U = x + φy` (which the map multiplies by φ²) and `S = φx − y` (by φ⁻²) it is
    /// `x = (U/φ + S)/√5`, `y = (U − S/φ)/√5`, where
    /// `U = Σ φ^(−2m−2) (k + φl) + φ^(−2d) U_last` over the wraps `(k, l)`, `m` steps ahead of the
    /// middle, and `S = φ^(−2c) S_first − Σ φ^(−2m) (φk − l)` over those before it.
    fn estimate(&self, first: usize, middle: usize, last: usize) -> Option<State> {
        let power = |j: usize| POWERS.get(j + 1).copied();
        let minus_one = |j: usize| POWERS.get(j).copied(); // φ^(1−j)/√5
        let tail = |weight: i128, c: f64| (weight as f64 * c) as i128;
        let wrap = |j: usize| wraps(*self.window.get(j)?, *self.window.get(j + 1)?);
        let (mut x, mut y) = (0_i128, 0_i128);
        for j in middle..last {
            let ([k, l], m) = (wrap(j)?, j - middle);
            x += k * power(2 * m + 3)? + l * power(2 * m + 2)?;
            y += k * power(2 * m + 2)? + l * power(2 * m + 1)?;
        }
        for j in first..middle {
            let ([k, l], m) = (wrap(j)?, middle - 1 - j);
            x += l * power(2 * m)? - k * minus_one(2 * m)?;
            y += k * power(2 * m)? - l * power(2 * m + 1)?;
        }
        let (c, d) = (middle - first, last - middle);
        let [end_x, end_y] = *self.window.get(last)?;
        x += tail(power(2 * d + 1)?, end_x) + tail(power(2 * d)?, end_y);
        y += tail(power(2 * d)?, end_x) + tail(minus_one(2 * d)?, end_y);
        let [start_x, start_y] = *self.window.get(first)?;
        x += tail(minus_one(2 * c)?, start_x) - tail(power(2 * c)?, start_y);
        y += tail(power(2 * c + 1)?, start_y) - tail(power(2 * c)?, start_x);
        Some(State {
            a: self.modulus.round(x),
            b: self.modulus.round(y),
            modulus: self.modulus,
        })
    }
}

/// The whole numbers by which the map was wrapped between two points; none when no whole numbers
/// are close.
fn wraps(from: [f64; 2], to: [f64; 2]) -> Option<[i128; 2]> {
    let [x, y] = from;
    let exact = [x + y - to[0], x + 2.0 * y - to[1]];
    exact
        .iter()
        .all(|c| (c - c.round()).abs() <= MAX_RESIDUAL && c.abs() < 100.0)
        .then(|| exact.map(|c| c.round() as i128))
}
