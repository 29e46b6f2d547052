//! The state of a cat map from noisy points.
//!
//! Consecutive points determine the integers `k_j` by which the map was wrapped,
//! `k_j = M z_j − z_{j+1}`. Along the direction in which the map expands (by φ² = 2.618), the following
//! wraps fix a state in the middle of the window ever more precisely. Along the contracting
//! direction, the preceding wraps do. When both errors are below the spacing of the integers,
//! rounding gives the state.
//!
//! A Kalman filter predicts each point, so that wraps can be determined even across missing points.
//! The error then grows by φ² with every step, but in one direction only, and few integers lie in
//! so narrow a strip. All of them are followed until the next points decide.

mod estimate;
mod history;
mod ring;

use core::ops::RangeInclusive;
use std::collections::VecDeque;

use self::history::{History, ObservedPoint};
pub use self::ring::CatModulus;
use self::ring::State;
use super::OrbitTrack;
use chaotic_maps::AnySource;

/// Number of observations at the start and at the end of a window that are not used for the
/// estimate.
const CHECKED_BEFORE: usize = 2;
const CHECKED_AFTER: usize = 3;

/// Maximum number of stored steps; earlier states would add nothing.
const MAX_WINDOW: usize = 118;

/// Maximum number of steps for which an orbit is followed without a point.
const MAX_STEPS: u32 = 9;

/// Range of the assumed standard deviation of the noise (side of the square).
const NOISE: RangeInclusive<f64> = 0.002..=0.04;

/// Default of the assumed noise (side of the square).
const USUAL_NOISE: f64 = 0.02;

/// Reciprocal of the share of a window's observations that may lie off the recovered orbit.
const STRAY: usize = 10;

/// Maximum excess of the cost of a history of wraps over the best one: odds of e⁻¹².
const MARGIN: f64 = 12.0;

/// Maximum number of histories.
const MAX_HISTORIES: usize = 48;

/// Recovers the state of a cat map from noisy points.
///
/// It needs some 77 steps modulo 2⁵¹ (from the time at which the `f64` orbit is on its grid), 93
/// modulo the prime and 94 modulo 2⁶⁴. Missing points do not matter up to eight in a row.
#[derive(Debug, Clone)]
pub struct CatRecovery {
    modulus: CatModulus,
    sd: f64,
    /// One entry per step; the first and the last were observed.
    window: VecDeque<Option<ObservedPoint>>,
    histories: Vec<History>,
    /// Steps since the last observed point.
    missed: u32,
    found: Option<OrbitTrack>,
}

impl CatRecovery {
    /// Returns an observer with a known modulus, an assumed noise of 2 % of the side and no
    /// observations.
    pub fn new(modulus: CatModulus) -> Self {
        Self::with_noise(modulus, USUAL_NOISE)
    }

    /// Like [`CatRecovery::new`], for noise of another standard deviation (side of the square).
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

    /// Processes the next observed point, in units of the square; noise may move it outside.
    ///
    /// Returns `true` if it fits those before, if any; otherwise the collection has started over
    /// with it. Non-finite numbers count as a [`CatRecovery::gap`].
    pub fn observe(&mut self, point: [f64; 2]) -> bool {
        self.observe_with(point, self.sd)
    }

    /// Like [`CatRecovery::observe`], with the noise of this point.
    pub fn observe_with(&mut self, point: [f64; 2], sd: f64) -> bool {
        if !point.iter().all(|c| c.is_finite()) {
            self.gap();
            return true;
        }
        let sd = sd.min(*NOISE.end()).max(*NOISE.start());
        let seen = ObservedPoint { point, sd };
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
            .map(OrbitTrack::new);
        fits
    }

    /// Marks the next point as not observed.
    ///
    /// After too many of them in a row the collection starts over; a recovered orbit continues.
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

    /// Starts over, for use after an unknown number of missed points.
    pub fn forget(&mut self) {
        self.window.clear();
        self.histories.clear();
        self.missed = 0;
        self.found = None;
    }

    /// Returns the generator, once recovered and verified; its next point is the next one to be
    /// observed.
    pub fn state(&self) -> Option<&AnySource> {
        self.found.as_ref().map(|found| &found.source)
    }

    /// Returns the cost of the points: minus the logarithm of their likelihood against that of
    /// points anywhere. Negative if they look like an orbit.
    pub fn cost(&self) -> f64 {
        self.histories.first().map_or(0.0, |best| best.cost)
    }

    /// Drops the excess length of the window, up to the next observed point.
    fn shorten(&mut self) {
        while self.window.len() > MAX_WINDOW || matches!(self.window.front(), Some(None)) {
            self.window.pop_front();
            for history in &mut self.histories {
                history.wraps.pop_front();
            }
        }
    }

    /// Returns the last state of the window, if the window suffices and exactly one exact orbit
    /// fits it.
    fn recover(&self) -> Option<State> {
        let count = self.places().count();
        let (first, start) = self.places().nth(CHECKED_BEFORE)?;
        let (last, end) = self.places().nth(count.checked_sub(1 + CHECKED_AFTER)?)?;
        let middle = usize::midpoint(first, last);
        // Each step on either side is worth log₂ φ² = 1.388 bits; the points at the ends supply the
        // rest. If rounding fails, the points beyond show it. Wraps without a point follow from the
        // condition that the orbit is one of integers, for which the window must be longer.
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

    /// Returns the last state of the orbit with this state in the middle, if it fits the window.
    fn run_through(&self, state: State, first: usize, middle: usize, last: usize) -> Option<State> {
        let mut stray = 0;
        let mut check = |state: &State, place: usize, seen: &Option<ObservedPoint>| {
            let agrees = seen.as_ref().is_none_or(|seen| state.agrees(seen));
            stray += usize::from(!agrees);
            // All points that test the result must agree.
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

    /// Returns the observed points, with their places in the window.
    fn places(&self) -> impl Iterator<Item = (usize, ObservedPoint)> + '_ {
        self.window
            .iter()
            .enumerate()
            .filter_map(|(place, seen)| Some((place, (*seen)?)))
    }
}
