//! The state of a cat map from noisy points.
//!
//! Consecutive points tell the integers `k_j` by which the map was wrapped,
//! `k_j = M z_j − z_{j+1}`. Along the direction in which the map expands (by φ² = 2.618), the wraps to
//! come fix a state in the middle of the window ever more precisely; along the one in which it
//! contracts, the wraps before do. As soon as both are known better than the spacing of the
//! integers, rounding gives the state.
//!
//! A Kalman filter foretells each point, so that wraps can be told even where points are missing:
//! the error then grows by φ² with every step, but in one direction only, and few integers lie in so
//! narrow a strip. All that do are followed until the next points decide.

use core::ops::RangeInclusive;
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
const CHECKED_BEFORE: usize = 2;
const CHECKED_AFTER: usize = 3;

/// Steps kept; the states before would add nothing.
const MAX_WINDOW: usize = 118;

/// Steps over which an orbit can be followed without a point.
const MAX_STEPS: u32 = 9;

/// Standard deviations of the noise that can be reckoned with [side of the square].
const NOISE: RangeInclusive<f64> = 0.002..=0.04;

/// Noise that is reckoned with unless another one is given [side of the square].
const USUAL_NOISE: f64 = 0.02;

/// Largest square of a deviation from what was foretold [variances]: one in eight thousand is larger.
const GATE: f64 = 18.0;

/// Largest deviation of an observed coordinate from a claimed orbit [standard deviations].
const TOLERANCE: f64 = 6.0;

/// Observations of a window that may lie off the claimed orbit: one in so many.
const STRAY: usize = 10;

/// By how much a history of wraps may cost more than the best one: odds of e⁻¹².
const MARGIN: f64 = 12.0;

/// Wraps beyond these are none; those of [`MAX_STEPS`] are far fewer.
const MAX_WRAP: f64 = 1e6;

/// Histories followed at a time.
const MAX_HISTORIES: usize = 48;

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
    fn agrees(&self, seen: &Seen) -> bool {
        let scale = (1_u128 << self.modulus.bits()) as f64;
        seen.close([self.a as f64 / scale, self.b as f64 / scale])
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

/// A point as observed.
#[derive(Debug, Clone, Copy)]
struct Seen {
    point: [f64; 2],
    /// Standard deviation of each coordinate.
    sd: f64,
}

impl Seen {
    /// Whether a point of the torus is within the tolerance, by coordinate.
    fn close(&self, other: [f64; 2]) -> bool {
        self.point.iter().zip(other).all(|(a, b)| {
            let difference = a - b;
            (difference - difference.round()).abs() <= TOLERANCE * self.sd
        })
    }
}

/// The wraps between the points of the window, and where the orbit is now.
#[derive(Debug, Clone)]
struct History {
    /// One per step; those of steps without a point are part of the next one's.
    wraps: VecDeque<[i64; 2]>,
    /// Estimate of the last point, and its covariance: xx, xy, yy.
    z: [f64; 2],
    p: [f64; 3],
    /// What its points cost: minus the logarithm of their likelihood, as against points that lie
    /// anywhere in the square.
    cost: f64,
}

impl History {
    fn new(seen: &Seen) -> Self {
        let variance = seen.sd * seen.sd;
        Self {
            wraps: VecDeque::new(),
            z: seen.point,
            p: [variance, 0.0, variance],
            cost: 0.0,
        }
    }

    /// Appends to `into` every way in which the next point, `steps` on, can go on.
    fn extend<'a>(&'a self, steps: u32, seen: &Seen, into: &mut Vec<Next<'a>>) {
        // M to the power of the steps: ((p, q), (q, p + q)).
        let (mut p, mut q) = (1.0, 1.0);
        for _ in 1..steps {
            (p, q) = (p + q, p + 2.0 * q);
        }
        let r = p + q;
        let [x, y] = self.z;
        let [xx, xy, yy] = self.p;
        let ahead = [p * x + q * y, q * x + r * y];
        // M P Mᵀ, and the sum with the noise of the point.
        let [a, b, c] = [
            p * p * xx + 2.0 * p * q * xy + q * q * yy,
            p * q * xx + (p * r + q * q) * xy + q * r * yy,
            q * q * xx + 2.0 * q * r * xy + r * r * yy,
        ];
        let noise = seen.sd * seen.sd;
        let (sa, sc) = (a + noise, c + noise);
        let determinant = sa * sc - b * b;
        if !(determinant > 0.0 && determinant.is_finite()) {
            return;
        }
        let off = [ahead[0] - seen.point[0], ahead[1] - seen.point[1]];
        // One row of wraps after the other: the second given the first lies in a narrow range.
        for first in whole_numbers(off[0], (GATE * sa).sqrt()) {
            let dx = off[0] - first as f64;
            let rest = GATE - dx * dx / sa;
            let spread = (rest.max(0.0) * determinant / sa).sqrt();
            for second in whole_numbers(off[1] - dx * b / sa, spread) {
                let dy = off[1] - second as f64;
                let (u, v) = (
                    (sc * dx - b * dy) / determinant,
                    (sa * dy - b * dx) / determinant,
                );
                into.push(Next {
                    history: self,
                    wraps: [first, second],
                    z: [seen.point[0] + noise * u, seen.point[1] + noise * v],
                    // R − R S⁻¹ R.
                    p: [
                        noise - noise * noise * sc / determinant,
                        noise * noise * b / determinant,
                        noise - noise * noise * sa / determinant,
                    ],
                    cost: self.cost
                        + 0.5 * (dx * u + dy * v)
                        + 0.5 * libm::log(determinant)
                        + libm::log(core::f64::consts::TAU),
                });
            }
        }
    }
}

/// How a history may go on.
struct Next<'a> {
    history: &'a History,
    wraps: [i64; 2],
    z: [f64; 2],
    p: [f64; 3],
    cost: f64,
}

impl Next<'_> {
    fn history(&self, steps: u32) -> History {
        let mut wraps = VecDeque::with_capacity(MAX_WINDOW + MAX_STEPS as usize);
        wraps.extend(&self.history.wraps);
        wraps.extend((1..steps).map(|_| [0, 0]));
        wraps.push_back(self.wraps);
        History {
            wraps,
            z: self.z,
            p: self.p,
            cost: self.cost,
        }
    }
}

/// The whole numbers within `spread` of a number; none where they could not be counted.
fn whole_numbers(center: f64, spread: f64) -> RangeInclusive<i64> {
    let (low, high) = ((center - spread).ceil(), (center + spread).floor());
    if low.abs().max(high.abs()) < MAX_WRAP {
        low as i64..=high as i64
    } else {
        RangeInclusive::new(1, 0)
    }
}

/// Recovers the state of a cat map from noisy points.
///
/// Needs some 77 steps modulo 2⁵¹ (counted from where the `f64` orbit is on its grid), 93 modulo the
/// prime and 94 modulo 2⁶⁴; points missing among them do not matter as long as there are no nine in
/// a row.
#[derive(Debug, Clone)]
pub struct CatRecovery {
    modulus: CatModulus,
    sd: f64,
    /// One per step; the first and the last were seen.
    window: VecDeque<Option<Seen>>,
    histories: Vec<History>,
    /// Steps since the last point that was seen.
    missed: u32,
    found: Option<Tracked>,
}

impl CatRecovery {
    /// An observer who knows the modulus, reckons with a noise of 2 % of the side and has seen
    /// nothing.
    pub fn new(modulus: CatModulus) -> Self {
        Self::with_noise(modulus, USUAL_NOISE)
    }

    /// As [`CatRecovery::new`], for noise of another standard deviation [side of the square].
    ///
    /// Values outside 0.002 to 0.04 count as the closer of these, as does NaN as 0.04.
    pub fn with_noise(modulus: CatModulus, sd: f64) -> Self {
        Self {
            modulus,
            sd: sd.min(*NOISE.end()).max(*NOISE.start()),
            window: VecDeque::new(),
            histories: Vec::new(),
            missed: 0,
            found: None,
        }
    }

    /// Takes the next point as observed, in units of the square; noise may carry it outside.
    ///
    /// Says whether it fits those before, if there are any; otherwise the collection has started over
    /// with it. Non-finite numbers count as a [`CatRecovery::gap`].
    pub fn observe(&mut self, point: [f64; 2]) -> bool {
        self.observe_with(point, self.sd)
    }

    /// As [`CatRecovery::observe`], with the noise of this point.
    pub fn observe_with(&mut self, point: [f64; 2], sd: f64) -> bool {
        if !point.iter().all(|c| c.is_finite()) {
            self.gap();
            return true;
        }
        let sd = sd.min(*NOISE.end()).max(*NOISE.start());
        let seen = Seen { point, sd };
        if let Some(found) = &mut self.found {
            if found.follow(|symmetric| seen.close(symmetric.map(|c| 0.5 * (c + 1.0)))) {
                return true;
            }
            self.forget();
        }
        let steps = self.missed + 1;
        let mut next = Vec::new();
        for history in &self.histories {
            history.extend(steps, &seen, &mut next);
        }
        next.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let limit = next.first().map_or(0.0, |best| best.cost) + MARGIN;
        let mut next: Vec<History> = next
            .iter()
            .take_while(|next| next.cost <= limit)
            .take(MAX_HISTORIES)
            .map(|next| next.history(steps))
            .collect();
        let fits = self.histories.is_empty() || !next.is_empty();
        if next.is_empty() {
            self.window.clear();
            next.push(History::new(&seen));
        } else {
            self.window.extend((1..steps).map(|_| None));
        }
        self.histories = next;
        self.missed = 0;
        self.window.push_back(Some(seen));
        self.shorten();
        self.found = self
            .recover()
            .and_then(|state| state.source())
            .map(Tracked::new);
        fits
    }

    /// Says that the next point was not seen.
    ///
    /// After too many of them in a row the collection starts over; a recovered orbit goes on.
    pub fn gap(&mut self) {
        if let Some(found) = &mut self.found {
            found.follow(|_| true);
        } else {
            self.missed = self.missed.saturating_add(1);
            if self.missed >= MAX_STEPS {
                self.forget();
            }
        }
    }

    /// Starts over, for when it is not known how many points were missed.
    pub fn forget(&mut self) {
        self.window.clear();
        self.histories.clear();
        self.missed = 0;
        self.found = None;
    }

    /// The generator, once recovered and verified; its next point is the next one to be observed.
    pub fn state(&self) -> Option<&AnySource> {
        self.found.as_ref().map(|found| &found.source)
    }

    /// What the points cost, as minus the logarithm of their likelihood against that of points that
    /// lie anywhere: negative if they look like an orbit.
    pub fn cost(&self) -> f64 {
        self.histories.first().map_or(0.0, |best| best.cost)
    }

    /// Drops what the window is too long for, up to the next point that was seen.
    fn shorten(&mut self) {
        while self.window.len() > MAX_WINDOW || matches!(self.window.front(), Some(None)) {
            self.window.pop_front();
            for history in &mut self.histories {
                history.wraps.pop_front();
            }
        }
    }

    /// The last state of the window, if the window suffices and exactly one exact orbit runs through
    /// it.
    fn recover(&self) -> Option<State> {
        let count = self.places().count();
        let (first, start) = self.places().nth(CHECKED_BEFORE)?;
        let (last, end) = self.places().nth(count.checked_sub(1 + CHECKED_AFTER)?)?;
        let middle = usize::midpoint(first, last);
        // Each step on either side is worth log₂ φ² = 1.388 bits; the points at the ends tell the
        // rest. Should rounding fail, the points beyond show it. Wraps that no point tells are told
        // by the orbit's being one of integers, for which the window must be longer.
        let bits = f64::from(self.modulus.bits())
            + libm::log2(6.0 * start.sd.max(end.sd))
            + libm::log2(self.histories.len() as f64);
        if 1.388 * (middle.checked_sub(first)? as f64) < bits || 2 * count < self.window.len() {
            return None;
        }
        let mut found: Option<State> = None;
        for history in &self.histories {
            let state = self.estimate(&history.wraps, first, middle, last)?;
            let Some(state) = self.run_through(state, first, middle, last) else {
                continue;
            };
            if found.is_some_and(|other| (other.a, other.b) != (state.a, state.b)) {
                return None;
            }
            found = Some(state);
        }
        found
    }

    /// The last state of the orbit with this state in the middle, if it runs through the window.
    fn run_through(&self, state: State, first: usize, middle: usize, last: usize) -> Option<State> {
        let mut stray = 0;
        let mut check = |state: &State, place: usize, seen: &Option<Seen>| {
            let agrees = seen.as_ref().is_none_or(|seen| state.agrees(seen));
            stray += usize::from(!agrees);
            // The points that test the claim must all do so.
            agrees || (place > first && place < last)
        };
        let mut back = state;
        for (place, seen) in self.window.iter().enumerate().take(middle).rev() {
            back.step_back();
            if !check(&back, place, seen) {
                return None;
            }
        }
        let mut ahead = state;
        for (place, seen) in self.window.iter().enumerate().skip(middle + 1) {
            ahead.step();
            if !check(&ahead, place, seen) {
                return None;
            }
        }
        (stray * STRAY <= self.places().count()).then_some(ahead)
    }

    /// The points seen, with their places in the window.
    fn places(&self) -> impl Iterator<Item = (usize, Seen)> + '_ {
        self.window
            .iter()
            .enumerate()
            .filter_map(|(place, seen)| Some((place, (*seen)?)))
    }

    /// The state at `middle` from the wraps between `first` and `last`, where points were seen.
    ///
    /// With `U = x + φy` (which the map multiplies by φ²) and `S = φx − y` (by φ⁻²) it is
    /// `x = (U/φ + S)/√5`, `y = (U − S/φ)/√5`, where
    /// `U = Σ φ^(−2m−2) (k + φl) + φ^(−2d) U_last` over the wraps `(k, l)`, `m` steps ahead of the
    /// middle, and `S = φ^(−2c) S_first − Σ φ^(−2m) (φk − l)` over those before it.
    ///
    /// Whole turns do not matter, so that sums may overflow.
    fn estimate(
        &self,
        wraps: &VecDeque<[i64; 2]>,
        first: usize,
        middle: usize,
        last: usize,
    ) -> Option<State> {
        let power = |j: usize| POWERS.get(j + 1).copied();
        let minus_one = |j: usize| POWERS.get(j).copied(); // φ^(1−j)/√5
        let tail = |weight: i128, c: f64| (weight as f64 * c) as i128;
        let wrap = |j: usize| wraps.get(j).map(|wrap| wrap.map(i128::from));
        let point = |j: usize| self.window.get(j)?.as_ref().map(|seen| seen.point);
        let (mut x, mut y) = (0_i128, 0_i128);
        let add = |sum: &mut i128, factor: i128, power: i128| {
            *sum = sum.wrapping_add(factor.wrapping_mul(power));
        };
        for j in middle..last {
            let ([k, l], m) = (wrap(j)?, j - middle);
            add(&mut x, k, power(2 * m + 3)?);
            add(&mut x, l, power(2 * m + 2)?);
            add(&mut y, k, power(2 * m + 2)?);
            add(&mut y, l, power(2 * m + 1)?);
        }
        for j in first..middle {
            let ([k, l], m) = (wrap(j)?, middle - 1 - j);
            add(&mut x, l, power(2 * m)?);
            add(&mut x, -k, minus_one(2 * m)?);
            add(&mut y, k, power(2 * m)?);
            add(&mut y, -l, power(2 * m + 1)?);
        }
        let (c, d) = (middle - first, last - middle);
        let [end_x, end_y] = point(last)?;
        let [start_x, start_y] = point(first)?;
        for term in [
            tail(power(2 * d + 1)?, end_x),
            tail(power(2 * d)?, end_y),
            tail(minus_one(2 * c)?, start_x),
            -tail(power(2 * c)?, start_y),
        ] {
            x = x.wrapping_add(term);
        }
        for term in [
            tail(power(2 * d)?, end_x),
            tail(minus_one(2 * d)?, end_y),
            tail(power(2 * c + 1)?, start_y),
            -tail(power(2 * c)?, start_x),
        ] {
            y = y.wrapping_add(term);
        }
        Some(State {
            a: self.modulus.round(x),
            b: self.modulus.round(y),
            modulus: self.modulus,
        })
    }
}
