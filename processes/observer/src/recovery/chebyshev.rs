//! The state of an exact Chebyshev map from noisy points.
//!
//! A point of [`ChebP`] determines `s = |t/P|` (from 0 to 1/2) up to noise, but not the sign of
//! `t`. Each step multiplies by 6 and wraps. With the wraps `k_j` the first state is
//! `t_0/P = Σ k_j/6^(j+1) + θ_n/6ⁿ`, so that after some 23 steps rounding gives it exactly. Where
//! a point is close to 0 or 1/2 both signs fit the wraps. All histories that the noise allows are
//! followed, and the exact orbits of their roundings decide.

use core::f64::consts::TAU;
use std::collections::VecDeque;

use super::OrbitTrack;
use chaotic_maps::AnySource;
use chaotic_maps::chebyshev::{ChebP, Emission};
use chaotic_maps::modulus::{P, add};

/// Range of the assumed standard deviation of the noise, in units of [−1, 1]. With more noise, one
/// point would give hardly more information than the map removes.
const NOISE: core::ops::RangeInclusive<f64> = 0.002..=0.04;

/// Maximum number of steps of the estimate: the wraps of more would not fit 64 bits.
const MAX_ESTIMATED: usize = 23;

/// Minimum number of bits that the observations after these must test.
const CHECKED_BITS: f64 = 17.0;

/// Maximum number of stored observations while several orbits agree with all of them.
const MAX_WINDOW: usize = 34;

/// Maximum number of steps for which an orbit is followed without an observation.
const MAX_STEPS: u32 = 4;

/// Maximum squared deviation from the prediction (variances).
const GATE: f64 = 18.0;

/// Minimum excess (variances of the fit, or tenths of the assumed ones) of the sum of squares of
/// every other orbit over that of the recovered one: odds of e⁻¹⁰.
const MARGIN: f64 = 20.0;

/// Histories followed at a time.
const MAX_HISTORIES: usize = 2048;

/// Maximum deviation (standard deviations) of an observation from a recovered orbit.
const MAX_DEVIATION: f64 = 5.0;

/// Returns the maximum sum of squares (variances) of `count` deviations: mean + 4 standard
/// deviations of its distribution.
fn max_squares(count: usize) -> f64 {
    let count = count as f64;
    count + 4.0 * (2.0 * count).sqrt()
}

/// Observation: `s`, its variance, and the steps since the one before.
#[derive(Debug, Clone, Copy)]
struct OrbitSample {
    s: f64,
    variance: f64,
    steps: u32,
}

impl OrbitSample {
    /// Converts a coordinate in [−1, 1] with noise (which may move it outside) of a standard
    /// deviation.
    fn new(emission: Emission, c: f64, sd: f64, steps: u32) -> Self {
        let (s, slope) = match emission {
            Emission::Arcsine => (0.25 * (1.0 - c), 0.25),
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
            steps,
        }
    }

    /// Returns its information (bits): it agrees within four standard deviations with this share of
    /// all orbits.
    fn bits(self) -> f64 {
        -libm::log2((16.0 * self.variance.sqrt()).min(1.0))
    }

    /// Returns the squared deviation of a state, in variances.
    fn square(self, t: u64) -> f64 {
        let difference = t.min(P - t) as f64 / P as f64 - self.s;
        difference * difference / self.variance
    }
}

/// History of wraps that fits the observations so far.
#[derive(Debug, Clone, Copy)]
struct History {
    /// Current estimate of `t/P`, in [−1/2, 1/2], and its variance.
    theta: f64,
    variance: f64,
    /// `Σ k_j 6^(n−1−j)`; long histories lose whole turns of 64 bits.
    wraps: i64,
    /// Sum of squares of the innovations, in variances.
    cost: f64,
    /// Minus the logarithm of the likelihood, relative to observations anywhere.
    surprise: f64,
}

/// Recovers the state of a [`ChebP`] from consecutive noisy points; it needs 26 to 28 of them,
/// seldom more. One or two missing ones do not matter.
///
/// Both axes must be recovered from the same points: the chance that other points pass as an orbit
/// is below 2⁻²⁵ per axis.
#[derive(Debug, Clone)]
pub struct ChebyshevRecovery {
    emission: Emission,
    sd: f64,
    window: VecDeque<[OrbitSample; 2]>,
    /// Histories of each axis that the observations allow.
    now: [Vec<History>; 2],
    /// Steps since the last observed point.
    missed: u32,
    found: Option<OrbitTrack>,
}

impl ChebyshevRecovery {
    /// Returns an observer with a known form of the points, an assumed noise of 2 % of the half
    /// side and no observations.
    ///
    /// Points in the raw form contain less information on the states close to the edges; more of
    /// them are needed.
    pub fn new(emission: Emission) -> Self {
        Self::with_noise(emission, 0.02)
    }

    /// Like [`ChebyshevRecovery::new`], for noise of another standard deviation, in units of [−1,
    /// 1].
    ///
    /// Values outside 0.002 to 0.04 count as the closer of these, as does NaN as 0.04. With 0.04
    /// one recovery in six takes 30 to 34 points.
    pub fn with_noise(emission: Emission, sd: f64) -> Self {
        Self {
            emission,
            sd: sd.min(*NOISE.end()).max(*NOISE.start()),
            window: VecDeque::with_capacity(MAX_WINDOW),
            now: [Vec::new(), Vec::new()],
            missed: 0,
            found: None,
        }
    }

    /// Processes the next observed point, in units of the square [−1, 1]²; noise may move it
    /// outside.
    ///
    /// Returns `true` if it fits those before, if any; otherwise the collection has started over
    /// with it. Non-finite numbers count as a [`ChebyshevRecovery::gap`].
    pub fn observe(&mut self, point: [f64; 2]) -> bool {
        self.observe_with(point, [self.sd; 2])
    }

    /// Like [`ChebyshevRecovery::observe`], with the noise of this point's coordinates.
    pub fn observe_with(&mut self, point: [f64; 2], sd: [f64; 2]) -> bool {
        if !point.iter().all(|c| c.is_finite()) {
            self.gap();
            return true;
        }
        let sd = sd.map(|sd| sd.min(*NOISE.end()).max(*NOISE.start()));
        if let Some(found) = &mut self.found {
            if found.follow(|expected| {
                (0..2).all(|k| (point[k] - expected[k]).abs() <= MAX_DEVIATION * sd[k])
            }) {
                return true;
            }
            self.forget();
        }
        let steps = self.missed + 1;
        self.missed = 0;
        let seen = [0, 1].map(|k| OrbitSample::new(self.emission, point[k], sd[k], steps));
        for (now, seen) in self.now.iter_mut().zip(seen) {
            *now = extended(now, &seen, f64::INFINITY);
        }
        let goes_on = !self.now.iter().any(Vec::is_empty);
        let fits = goes_on || self.window.is_empty();
        if !goes_on {
            self.window.clear();
            self.now = seen.map(|seen| vec![History::new(&seen)]);
        }
        if self.window.len() == MAX_WINDOW {
            self.window.pop_front();
        }
        self.window.push_back(seen);
        self.found = self
            .recover()
            .map(|map| OrbitTrack::new(AnySource::ChebP(map)));
        fits
    }

    /// Marks the next point as not observed.
    ///
    /// After too many of them in a row the collection starts over; a recovered orbit continues.
    pub fn gap(&mut self) {
        if let Some(found) = &mut self.found {
            found.follow(|_| true);
        } else {
            self.missed += 1;
            if self.missed >= MAX_STEPS {
                self.forget();
            }
        }
    }

    /// Returns the cost of the points: minus the logarithm of their likelihood against that of
    /// points anywhere. Negative if they look like an orbit.
    pub fn cost(&self) -> f64 {
        let least = |now: &Vec<History>| now.first().map_or(0.0, |best| best.surprise);
        self.now.iter().map(least).sum()
    }

    /// Starts over, for use after an unknown number of missed points.
    pub fn forget(&mut self) {
        self.window.clear();
        self.now.iter_mut().for_each(Vec::clear);
        self.missed = 0;
        self.found = None;
    }

    /// Returns the generator, once recovered and verified; its next point is the next one to be
    /// observed.
    ///
    /// Its states are those of the original up to sign, which no point shows.
    pub fn state(&self) -> Option<&AnySource> {
        self.found.as_ref().map(|found| &found.source)
    }

    fn recover(&self) -> Option<ChebP> {
        let axis = |axis: fn(&[OrbitSample; 2]) -> OrbitSample| {
            recover_axis(&self.window.iter().map(axis).collect::<Vec<_>>())
        };
        let tx = axis(|both| both[0])?;
        let ty = axis(|both| both[1])?;
        ChebP::new(tx, ty, self.emission).ok()
    }
}

/// Comparison of an exact orbit with the observations.
struct Fit {
    /// Its last state.
    state: u64,
    /// Sum of squares of the deviations, in variances.
    squares: f64,
}

/// Returns the observations of one axis for the estimate, the steps between the first and the last
/// of them, and the bits that the later ones test; none if they do not suffice.
fn estimated(observed: &[OrbitSample]) -> Option<(&[OrbitSample], usize, f64)> {
    let (mut steps, mut most) = (0, None);
    for (count, o) in observed.iter().enumerate() {
        if count > 0 {
            steps += o.steps as usize;
        }
        if steps > MAX_ESTIMATED {
            break;
        }
        // Each step gives log₂ 6 bits. The last must determine the first state to a twelfth of the
        // spacing of the integers; slightly less suffices, as the others test it.
        let bits = 2.585 * steps as f64 - libm::log2(12.0 * o.variance.sqrt());
        if bits >= 62.0 {
            most = Some((count, steps));
        }
        if bits >= 63.0 {
            break;
        }
    }
    let (count, steps) = most?;
    let (made_from, tests) = observed.split_at_checked(count + 1)?;
    let bits = tests.iter().map(|o| o.bits()).sum();
    Some((made_from, steps, bits))
}

/// Returns the state at the last of the observations of one axis, if exactly one exact orbit fits
/// all of them.
fn recover_axis(observed: &[OrbitSample]) -> Option<u64> {
    let (made_from, steps, bits) = estimated(observed)?;
    if bits < CHECKED_BITS {
        return None;
    }
    let scale = 6_i128.pow(steps as u32);
    let limit = max_squares(observed.len());
    let mut best: Option<Fit> = None;
    let mut second = f64::INFINITY;
    for history in histories(made_from) {
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
        // If the noise is lower than assumed, smaller differences separate the orbits.
        let variance = (best.squares / observed.len() as f64).clamp(0.1, 1.0);
        best.squares <= limit && best.squares + MARGIN * variance <= second
    })
    .map(|best| best.state)
}

/// Compares the orbit from `t` with the observations; none once it deviates by more than `limit`.
fn follow(t: u64, observed: &[OrbitSample], limit: f64) -> Option<Fit> {
    let (mut state, mut squares) = (t, 0.0);
    for (number, o) in observed.iter().enumerate() {
        for _ in 0..if number == 0 { 0 } else { o.steps } {
            let triple = add(add(state, state), state);
            state = add(triple, triple);
        }
        squares += o.square(state);
        if squares > limit {
            return None;
        }
    }
    Some(Fit { state, squares })
}

/// Returns the histories that the observations allow.
fn histories(observed: &[OrbitSample]) -> Vec<History> {
    let Some((first, rest)) = observed.split_first() else {
        return Vec::new();
    };
    let limit = max_squares(observed.len());
    rest.iter().fold(vec![History::new(first)], |histories, o| {
        extended(&histories, o, limit)
    })
}

/// Returns the histories with one more observation that cost no more than `limit`, the likeliest
/// first.
fn extended(histories: &[History], o: &OrbitSample, limit: f64) -> Vec<History> {
    let mut next = Vec::new();
    for history in histories {
        for signed in [o.s, -o.s] {
            history.extend(signed, o, limit, &mut next);
        }
    }
    next.sort_by(|a, b| a.surprise.total_cmp(&b.surprise));
    next.truncate(MAX_HISTORIES);
    next
}

impl History {
    /// The sign of the first state is free: the orbits of t and −t have the same points.
    fn new(first: &OrbitSample) -> Self {
        Self {
            theta: first.s,
            variance: first.variance,
            wraps: 0,
            cost: 0.0,
            surprise: 0.0,
        }
    }

    /// Appends the histories with one more observation, with a sign (Kalman filter of one number),
    /// to `into`.
    fn extend(&self, signed: f64, o: &OrbitSample, limit: f64, into: &mut Vec<Self>) {
        let growth = 6_i64.saturating_pow(o.steps);
        let factor = growth as f64;
        let (predicted, prior) = (factor * self.theta, factor * factor * self.variance);
        let sum = prior + o.variance;
        let spread = (GATE * sum).sqrt();
        let (low, high) = (predicted - signed - spread, predicted - signed + spread);
        for wrap in low.ceil() as i64..=high.floor() as i64 {
            let innovation = predicted - wrap as f64 - signed;
            let square = innovation * innovation / sum;
            if self.cost + square > limit {
                continue;
            }
            into.push(Self {
                theta: signed + innovation * o.variance / sum,
                variance: prior * o.variance / sum,
                wraps: growth.wrapping_mul(self.wraps).wrapping_add(wrap),
                cost: self.cost + square,
                // Relative to s anywhere between 0 and 1/2.
                surprise: self.surprise
                    + 0.5 * square
                    + 0.5 * libm::log(core::f64::consts::TAU * sum)
                    + core::f64::consts::LN_2,
            });
        }
    }
}
