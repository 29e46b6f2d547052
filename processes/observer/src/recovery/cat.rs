//! The state of a cat map from noisy points.
//!
//! Consecutive points tell the integers `k_j` by which the map was wrapped,
//! `k_j = M z_j − z_{j+1}`. Along the direction in which the map expands (by φ² = 2.618), the wraps to
//! come fix a state in the middle of the window ever more precisely; along the one in which it
//! contracts, the wraps before do. As soon as both are known better than the spacing of the
//! integers, rounding gives the state.
//!
//! A Kalman filter predicts each point, so that wraps can be told even where points are missing:
//! the error then grows by φ² with every step, but in one direction only, and few integers lie in so
//! narrow a strip. All that do are followed until the next points decide.

mod estimate;
mod history;
mod ring;

use core::ops::RangeInclusive;
use std::collections::VecDeque;

use self::history::{History, Seen};
pub use self::ring::CatModulus;
use self::ring::State;
use super::Tracked;
use chaotic_maps::AnySource;

/// Observations at the start and at the end of a window that take no part in the estimate.
const CHECKED_BEFORE: usize = 2;
const CHECKED_AFTER: usize = 3;

/// Steps kept; the states before would add nothing.
const MAX_WINDOW: usize = 118;

/// Steps over which an orbit can be followed without a point.
const MAX_STEPS: u32 = 9;

/// Standard deviations of the noise that can be reckoned with (side of the square).
const NOISE: RangeInclusive<f64> = 0.002..=0.04;

/// Noise that is reckoned with unless another one is given (side of the square).
const USUAL_NOISE: f64 = 0.02;

/// Observations of a window that may lie off the claimed orbit: one in so many.
const STRAY: usize = 10;

/// By how much a history of wraps may cost more than the best one: odds of e⁻¹².
const MARGIN: f64 = 12.0;

/// Histories followed at a time.
const MAX_HISTORIES: usize = 48;

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

    /// As [`CatRecovery::new`], for noise of another standard deviation (side of the square).
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
}
