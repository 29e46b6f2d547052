//! The state of an exact Chebyshev map from noisy points.
//!
//! A point of [`ChebP`] tells `s = |t/P|` (from 0 to 1/2) up to noise, but not the sign of `t`. Each
//! step multiplies by 6 and wraps; with the wraps `k_j` the first state is
//! `t_0/P = Σ k_j/6^(j+1) + θ_n/6ⁿ`, so that after some 23 steps rounding gives it exactly. Where a
//! point is close to 0 or 1/2 both signs fit the wraps: all histories that the noise allows are
//! followed, and the exact orbits of their roundings decide among them.

use core::f64::consts::TAU;
use std::collections::VecDeque;

use super::Tracked;
use crate::chebyshev::{ChebP, Emission};
use crate::modulus::{P, add};
use crate::source::AnySource;

/// Standard deviations of the noise that can be reckoned with, in units of [−1, 1]. With more, one
/// point would tell hardly more than the map takes away.
const NOISE: core::ops::RangeInclusive<f64> = 0.002..=0.04;

/// Observations that the estimate is made from. 23 steps are worth 59.5 bits, the last observation
/// the four that remain.
const ESTIMATED: usize = 24;

/// Observations after these that at least must test it.
const CHECKED_AFTER: usize = 4;

/// Observations kept while several orbits remain that agree with all of them.
const MAX_WINDOW: usize = ESTIMATED + CHECKED_AFTER + 6;

/// By how much [variances of the fit, or tenths of those reckoned with] the sum of squares of every other orbit must exceed that of the one
/// claimed: odds of e⁻¹⁰.
const MARGIN: f64 = 20.0;

/// Histories followed at a time.
const MAX_HISTORIES: usize = 4096;

/// Largest deviation [standard deviations] of an observation from a claimed orbit.
const MAX_DEVIATION: f64 = 5.0;

/// Largest sum of squares [variances] of `count` deviations: mean + 4 standard deviations of its
/// law.
fn max_squares(count: usize) -> f64 {
    let count = count as f64;
    count + 4.0 * (2.0 * count).sqrt()
}

/// An observation: `s`, and the variance with which it is known.
#[derive(Debug, Clone, Copy)]
struct Observed {
    s: f64,
    variance: f64,
}

impl Observed {
    /// From a coordinate in [−1, 1] with noise (which may carry it outside) of a standard deviation.
    fn new(emission: Emission, c: f64, sd: f64) -> Self {
        let (s, slope) = match emission {
            Emission::Arcsine => (0.25 * (1.0 - c), 0.25),
            Emission::Arccosine => (0.25 * (1.0 + c), 0.25),
            Emission::Raw => {
                let c = c.clamp(-1.0, 1.0);
                // The slope of acos has no bound at the edges, where c is known no better than sd.
                let sine = (1.0 - c * c).max(2.0 * sd).sqrt();
                (libm::acos(c) / TAU, 1.0 / (TAU * sine))
            }
        };
        let sd = sd * slope;
        Self {
            s,
            variance: sd * sd,
        }
    }

    /// The square of the deviation of a state, in variances.
    fn square(self, t: u64) -> f64 {
        let difference = t.min(P - t) as f64 / P as f64 - self.s;
        difference * difference / self.variance
    }
}

/// A history of wraps that fits the observations so far.
#[derive(Clone, Copy)]
struct History {
    /// Estimate of `t/P` now, in [−1/2, 1/2], and its variance.
    theta: f64,
    variance: f64,
    /// `Σ k_j 6^(n−1−j)`.
    wraps: i64,
    /// Sum of squares of the innovations, in variances.
    cost: f64,
}

/// Recovers the state of a [`ChebP`] from consecutive noisy points; needs 28 of them, seldom more.
///
/// Both axes must be recovered from the same points: the chance that points that come from
/// elsewhere pass as an orbit is below 2⁻²⁵ per axis.
#[derive(Debug, Clone)]
pub struct ChebyshevRecovery {
    emission: Emission,
    sd: f64,
    window: VecDeque<[Observed; 2]>,
    found: Option<Tracked>,
}

impl ChebyshevRecovery {
    /// An observer who knows the form of the points, reckons with a noise of up to 2 % of the half
    /// side, and has seen none.
    ///
    /// Points in the raw form tell less about the states close to the edges, and need more of them.
    pub fn new(emission: Emission) -> Self {
        Self::with_noise(emission, 0.02)
    }

    /// As [`ChebyshevRecovery::new`], for noise of another standard deviation, in units of [−1, 1].
    ///
    /// Values outside 0.002 to 0.04 count as the closer of these, as does NaN as 0.04. With 0.04
    /// one recovery in six takes 30 to 34 points.
    pub fn with_noise(emission: Emission, sd: f64) -> Self {
        Self {
            emission,
            sd: sd.min(*NOISE.end()).max(*NOISE.start()),
            window: VecDeque::with_capacity(MAX_WINDOW),
            found: None,
        }
    }

    /// Takes the next point as observed, in units of the square [−1, 1]²; noise may carry it
    /// outside.
    ///
    /// Non-finite numbers count as a [`ChebyshevRecovery::gap`].
    pub fn observe(&mut self, point: [f64; 2]) {
        if !point.iter().all(|c| c.is_finite()) {
            self.gap();
            return;
        }
        if let Some(found) = &mut self.found {
            let limit = MAX_DEVIATION * self.sd;
            if found.follow(|expected| {
                point
                    .iter()
                    .zip(expected)
                    .all(|(a, b)| (a - b).abs() <= limit)
            }) {
                return;
            }
            self.forget();
        }
        if self.window.len() == MAX_WINDOW {
            self.window.pop_front();
        }
        self.window
            .push_back(point.map(|c| Observed::new(self.emission, c, self.sd)));
        self.found = self
            .recover()
            .map(|map| Tracked::new(AnySource::ChebP(map)));
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
    ///
    /// Its states are those of the original up to sign, which no point shows.
    pub fn state(&self) -> Option<&AnySource> {
        self.found.as_ref().map(|found| &found.source)
    }

    fn recover(&self) -> Option<ChebP> {
        if self.window.len() < ESTIMATED + CHECKED_AFTER {
            return None;
        }
        let axis = |axis: fn(&[Observed; 2]) -> Observed| {
            recover_axis(&self.window.iter().map(axis).collect::<Vec<_>>())
        };
        let tx = axis(|both| both[0])?;
        let ty = axis(|both| both[1])?;
        ChebP::new(tx, ty, self.emission).ok()
    }
}

/// An exact orbit against the observations.
struct Fit {
    /// Its last state.
    state: u64,
    /// Sum of squares of the deviations, in variances.
    squares: f64,
}

/// The state at the last of the observations of one axis, if exactly one exact orbit runs through
/// all of them.
fn recover_axis(observed: &[Observed]) -> Option<u64> {
    let steps = ESTIMATED.min(observed.len()).checked_sub(1)?;
    let scale = 6_i128.pow(steps as u32);
    let limit = max_squares(observed.len());
    let mut best: Option<Fit> = None;
    let mut second = f64::INFINITY;
    for history in histories(observed.get(..=steps)?) {
        // θ_n·P is some four bits above the spacing: f64 suffices.
        let numerator =
            i128::from(history.wraps) * i128::from(P) + (history.theta * P as f64) as i128;
        let first = (numerator + scale / 2).div_euclid(scale);
        let start = first.rem_euclid(i128::from(P)) as u64;
        let Some(fit) = follow(start, observed, limit + MARGIN) else {
            continue;
        };
        match &mut best {
            Some(best) if best.state == fit.state || best.state == P - fit.state => {}
            Some(best) if best.squares <= fit.squares => second = second.min(fit.squares),
            _ => {
                second = best.map_or(second, |best| second.min(best.squares));
                best = Some(fit);
            }
        }
    }
    best.filter(|best| {
        // Where the noise is less than reckoned with, less tells the others apart.
        let variance = (best.squares / observed.len() as f64).clamp(0.1, 1.0);
        best.squares <= limit && best.squares + MARGIN * variance <= second
    })
    .map(|best| best.state)
}

/// The orbit from `t` against the observations; none once it deviates by more than `limit`.
fn follow(t: u64, observed: &[Observed], limit: f64) -> Option<Fit> {
    let (mut next, mut state, mut squares) = (t, t, 0.0);
    for o in observed {
        state = next;
        squares += o.square(state);
        if squares > limit {
            return None;
        }
        let triple = add(add(state, state), state);
        next = add(triple, triple);
    }
    Some(Fit { state, squares })
}

/// The histories that the observations allow.
fn histories(observed: &[Observed]) -> Vec<History> {
    let Some((first, rest)) = observed.split_first() else {
        return Vec::new();
    };
    // The sign of the first state is free: the orbits of t and −t show the same points.
    let mut histories = vec![History {
        theta: first.s,
        variance: first.variance,
        wraps: 0,
        cost: 0.0,
    }];
    let limit = max_squares(observed.len());
    for o in rest {
        histories = histories
            .iter()
            .flat_map(|history| [o.s, -o.s].map(|signed| history.extended(signed, o.variance)))
            .filter(|history| history.cost <= limit)
            .collect();
        if histories.len() > MAX_HISTORIES {
            histories.select_nth_unstable_by(MAX_HISTORIES, |a, b| a.cost.total_cmp(&b.cost));
            histories.truncate(MAX_HISTORIES);
        }
    }
    histories
}

impl History {
    /// The history with one more observation, taken with a sign (Kalman filter of one number).
    fn extended(&self, signed: f64, variance: f64) -> Self {
        let (predicted, prior) = (6.0 * self.theta, 36.0 * self.variance);
        let wrap = (predicted - signed).round();
        let innovation = predicted - wrap - signed;
        let sum = prior + variance;
        Self {
            theta: signed + innovation * variance / sum,
            variance: prior * variance / sum,
            wraps: 6 * self.wraps + wrap as i64,
            cost: self.cost + innovation * innovation / sum,
        }
    }
}
