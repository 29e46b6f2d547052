//! Prediction by the key. An attacker who knows the method by which goals are made from a
//! generator's outputs can invert it, find the generator's state, and predict every following goal:
//! the attack on linear and on polynomial maps.
//!
//! Some goals are overlooked because the robot hardly turns at them, and some detections are false.
//! The assignment of detections to goals of the route is therefore not decided at once. All
//! hypotheses that the outputs allow are followed until the outputs decide.

use std::collections::VecDeque;

use chaotic_maps::{AnySource, Source as _};
use control::go_to::distance_to_segment;
use nalgebra::Point2;

mod guess;

pub use self::guess::Finder;
use self::guess::{Guess, MARGIN, RECENT, likeliest};
use super::Predictor;
use crate::layout::{Frame, Layout, Slot};
use crate::moment::{Moment, ReachedGoal};
use crate::travel::{Pace, along};

/// Maximum number of overlooked goals between two detections.
const OVERLOOKED: u64 = 4;
/// Cost of an overlooked goal, and of a detection without a goal: minus the logarithm of the
/// probability.
const MISSED_COST: f64 = 2.0;
const OUTLIER_COST: f64 = 4.0;
/// Number of consecutive outliers after which a hypothesis is dropped.
const MAX_OUTLIERS: u32 = 6;
/// The same when the key has been found.
const OUTLIERS_THAT_DROP_KEY: u32 = 12;
/// Maximum excess of the cost of a hypothesis with a recovered key over the best one.
const MARGIN_OF_CLAIM: f64 = 10.0;
/// Difference below which outputs belong to the same state: the sign of a Chebyshev map's state
/// affects the last bits only.
const SAME: f64 = 1e-9;
/// Maximum deviation of a detection from a known goal (standard deviations).
const MAX_DEVIATION: f64 = 4.5;
/// Number of goals computed ahead.
const AHEAD: usize = 64;
/// Standard deviation of an output from which on it says nothing: the goal counts as overlooked.
const VAGUE: f64 = 0.2;
/// Time from the start within which a robot is observed from its first goal on (s).
const START_S: f64 = 1.0;

/// A future goal.
#[derive(Debug, Clone, Copy)]
struct FutureGoal {
    /// Number in the rounds.
    number: u64,
    /// Output that it is made from; `None` for a fixed goal.
    output: Option<[f64; 2]>,
    goal: Point2<f64>,
}

/// Finds the key of a robot's goals and then predicts the following ones.
#[derive(Debug, Clone)]
pub struct KeyHunter<F> {
    layout: Layout,
    /// Returns a search without outputs.
    blank: F,
    /// Distance from its goal at which the robot turns to the next (m).
    arrival: f64,
    /// Maximum error of a detected goal (m).
    goal_error: f64,
    pace: Pace,
    goals: u32,
    guesses: Vec<Guess<F>>,
    /// Cost of the hypothesis that none of the goals so far belongs to the route.
    strange: f64,
    begun: bool,
    /// Last observed position of the robot (m).
    last: Option<Point2<f64>>,
    /// Future goals, once the key is known, and the generator of further ones.
    upcoming: VecDeque<FutureGoal>,
    source: Option<AnySource>,
    /// `true` while the end of the present run of goals is not known.
    is_floating: bool,
    /// Number of detections since a future goal was reached.
    outliers: u32,
}

impl<F: Finder> KeyHunter<F> {
    /// Returns a search for goals of this layout. The robot turns to the next goal within `arrival`
    /// (m), ≥ 0, of one; detections have errors mostly up to `goal_error` (m), > 0.
    pub fn new(layout: Layout, finder: F, arrival: f64, goal_error: f64) -> Self {
        Self {
            layout,
            blank: finder,
            arrival,
            goal_error,
            pace: Pace::default(),
            goals: 0,
            guesses: Vec::new(),
            strange: 0.0,
            begun: false,
            last: None,
            upcoming: VecDeque::new(),
            source: None,
            is_floating: false,
            outliers: 0,
        }
    }

    /// Returns the future goals, nearest first; none while the key is not known.
    pub fn upcoming(&self) -> impl Iterator<Item = Point2<f64>> + '_ {
        self.upcoming.iter().map(|upcoming| upcoming.goal)
    }

    fn forget(&mut self) {
        self.guesses.clear();
        self.strange = 0.0;
        self.outliers = 0;
        self.upcoming.clear();
        self.source = None;
        self.is_floating = false;
    }

    /// Returns a hypothesis that begins with a goal, anywhere in its run.
    fn begin(&self, number: u64, finder: F, cost: f64) -> Guess<F> {
        let [first, last] = self.layout.run_of(number);
        Guess {
            at: number,
            is_floating: first < last,
            finder,
            cost,
            outliers: 0,
            recent: [(self.goals, first); RECENT],
        }
    }

    /// Patrols usually begin at a fixed goal.
    fn begin_at_fixed(&mut self, place: Point2<f64>) {
        if let Some(number) = self.layout.fixed_near(place, 2.0 * self.goal_error) {
            let guess = self.begin(number, self.blank.clone(), 0.0);
            self.guesses.push(guess);
        }
    }

    /// Coverage begins before the first goal of a round.
    fn begin_at_start(&mut self) {
        let last = self.layout.round() - 1;
        if last > 0 && matches!(self.layout.slot(last), Slot::Drawn(_)) {
            let mut guess = self.begin(last, self.blank.clone(), 0.0);
            guess.is_floating = false;
            self.guesses.push(guess);
        }
    }

    /// Returns the goals that may follow that of a hypothesis after this number of overlooked ones:
    /// their numbers, and `true` if a goal may be any of its run.
    fn successors(&self, guess: &Guess<F>, overlooked: u64) -> Vec<(u64, bool)> {
        if !guess.is_floating {
            return vec![(guess.at + 1 + overlooked, false)];
        }
        let [_, last] = self.layout.run_of(guess.at);
        let beyond = (0..=overlooked).map(|beyond| (last + 1 + beyond, false));
        core::iter::once((guess.at, true)).chain(beyond).collect()
    }

    /// Processes a detection before the key is known; `lost` after a time out of sight.
    fn hunt(&mut self, goal: &ReachedGoal, lost: bool) {
        let mut next: Vec<Guess<F>> = Vec::new();
        let overlooked = if lost { 0.0 } else { MISSED_COST };
        for guess in &self.guesses {
            if guess.outliers + 1 < MAX_OUTLIERS {
                next.push(Guess {
                    cost: guess.cost + OUTLIER_COST,
                    outliers: guess.outliers + 1,
                    ..guess.clone()
                });
            }
            let (mut finder, mut cost) = (guess.finder.clone(), guess.cost);
            for skipped in 0..=OVERLOOKED {
                for (number, is_floating) in self.successors(guess, skipped) {
                    // All laps are alike.
                    let number = number % self.layout.round();
                    let slot = self.layout.slot(number);
                    if let Some((finder, extra)) = self.place(&finder, &slot, goal) {
                        let [first, _] = self.layout.run_of(number);
                        next.push(Guess {
                            is_floating,
                            ..guess.with(self.goals, [number, first], finder, cost + extra)
                        });
                    }
                }
                cost += overlooked;
                let skipped = self.layout.slot(guess.at + 1 + skipped);
                if guess.is_floating || matches!(skipped, Slot::Drawn(_)) {
                    finder.gap();
                }
            }
        }
        let best = next.iter().map(Guess::score).fold(f64::INFINITY, f64::min);
        if self.strange <= best + MARGIN {
            let mut number = 0;
            while number < self.layout.round() {
                let slot = self.layout.slot(number);
                let [_, last] = self.layout.run_of(number);
                if let Some((finder, extra)) = self.place(&self.blank, &slot, goal) {
                    next.push(self.begin(number, finder, self.strange + extra));
                }
                number = last + 1;
            }
        }
        self.strange += OUTLIER_COST;
        self.guesses = likeliest(next);
    }

    /// Returns the search after a detection at this place of the route, and its additional cost;
    /// `None` if it does not fit.
    fn place(&self, finder: &F, slot: &Slot, goal: &ReachedGoal) -> Option<(F, f64)> {
        match slot {
            Slot::Fixed(point) => {
                let off = (goal.point - point).norm() / goal.sd;
                // Relative to goals anywhere in the frame of a drawn one.
                let area = self.layout.area();
                let spread = core::f64::consts::TAU * goal.sd * goal.sd / area;
                let cost = 0.5 * off * off + geometry::math::ln(spread);
                (off <= MAX_DEVIATION).then(|| (finder.clone(), cost))
            }
            Slot::Drawn(frame) => {
                let (output, sd) = (frame.output(goal.point)?, sd_of(frame, goal));
                let inside = (0..2).all(|k| {
                    let slack = MAX_DEVIATION * sd[k];
                    (-slack..=1.0 + slack).contains(&output[k])
                });
                let mut finder = finder.clone();
                let fits = if sd[0].max(sd[1]) > VAGUE {
                    finder.gap();
                    true
                } else {
                    finder.observe(output, sd)
                };
                (inside && fits).then(|| (finder, self.layout.spread_cost(frame)))
            }
        }
    }

    /// Accepts the likeliest hypotheses if their searches have found the state, and the same one.
    fn claim(&mut self) {
        let Some(best) = self.guesses.first().map(Guess::score) else {
            return;
        };
        let mut found = self
            .guesses
            .iter()
            .take_while(|guess| guess.score() <= best + MARGIN_OF_CLAIM)
            .filter(|guess| guess.outliers == 0)
            .filter_map(|guess| Some((guess, guess.finder.source()?)));
        let Some((first, source)) = found.next() else {
            return;
        };
        let next = source.clone().next_unit();
        let mut at = (first.at, first.is_floating);
        let agree = found.all(|(other, mut source)| {
            let ([x, y], [u, v]) = (source.next_unit(), next);
            let same_place = match (at.1, other.is_floating) {
                (false, false) => other.at == at.0,
                _ => self.layout.run_of(other.at) == self.layout.run_of(at.0),
            };
            if !other.is_floating {
                at = (other.at, false);
            }
            same_place && (x - u).abs() < SAME && (y - v).abs() < SAME
        });
        if agree {
            self.forget();
            self.source = Some(source);
            self.is_floating = at.1;
            self.look_ahead(if at.1 { at.0 } else { at.0 + 1 });
        }
    }

    /// Assigns a detection to one of the future goals, after the key is known.
    fn follow(&mut self, goal: Point2<f64>, lost: bool) {
        let window = if lost || self.outliers >= MAX_OUTLIERS {
            AHEAD
        } else {
            1 + OVERLOOKED as usize
        };
        let found = self
            .upcoming
            .iter()
            .take(window)
            .position(|upcoming| (goal - upcoming.goal).norm() <= 2.0 * self.goal_error);
        let found = found.or_else(|| self.realign(goal, window));
        if let Some(found) = found {
            self.reach(found + 1);
            return;
        }
        self.outliers += 1;
        if self.outliers >= OUTLIERS_THAT_DROP_KEY {
            self.forget();
            self.begin_at_fixed(goal);
        }
    }

    /// Finds a detection among the goals that the next outputs make in the present run, or after it:
    /// the robot's place in the run may be mistaken. Returns its place among the future goals, which
    /// continue from there.
    fn realign(&mut self, goal: Point2<f64>, window: usize) -> Option<usize> {
        let number = self
            .upcoming
            .front()
            .filter(|_| self.layout.has_runs())?
            .number;
        let [first, last] = self.layout.run_of(number);
        let is_near = |number: u64, at: usize| {
            let output = self.upcoming.get(at).and_then(|upcoming| upcoming.output);
            let (Slot::Drawn(frame), Some(output)) = (self.layout.slot(number), output) else {
                return false;
            };
            (goal - frame.goal(output)).norm() <= 2.0 * self.goal_error
        };
        let stays = (0..window).find(|&at| first < last && is_near(number, at));
        let leaves = || {
            (0..=OVERLOOKED as usize).find_map(|beyond| {
                let number = last + 1 + beyond as u64;
                let at = (beyond..window).find(|&at| is_near(number, at))?;
                Some((beyond, at))
            })
        };
        let (begin, at) = match stays {
            Some(at) => (0, at),
            None => leaves().map(|(beyond, at)| (at - beyond, at))?,
        };
        self.is_floating = stays.is_some();
        let mut numbers = last + 1..;
        for upcoming in self.upcoming.iter_mut().skip(begin) {
            let number = stays.map_or_else(|| numbers.next(), |_| Some(number))?;
            if let (Slot::Drawn(frame), Some(output)) = (self.layout.slot(number), upcoming.output)
            {
                upcoming.number = number;
                upcoming.goal = frame.goal(output);
            }
        }
        Some(at)
    }

    /// Drops future goals that the robot is observed to reach.
    fn keep_pace(&mut self, from: Point2<f64>, to: Point2<f64>, sigma: f64) {
        let reach = self.arrival + 3.0 * sigma;
        while let Some(next) = self.upcoming.front()
            && distance_to_segment(next.goal, from, to) <= reach
        {
            self.reach(1);
        }
    }

    /// Drops this number of future goals.
    fn reach(&mut self, count: usize) {
        self.outliers = 0;
        let step = u64::from(!self.is_floating);
        let next = self.upcoming.back().map_or(0, |last| last.number + step);
        self.upcoming.drain(..count.min(self.upcoming.len()));
        self.look_ahead(next);
    }

    /// Computes future goals, if the key is known; `number` is the first new one.
    fn look_ahead(&mut self, mut number: u64) {
        let Some(source) = &mut self.source else {
            return;
        };
        while self.upcoming.len() < AHEAD {
            let (output, goal) = match self.layout.slot(number) {
                Slot::Fixed(point) => (None, point),
                Slot::Drawn(frame) => {
                    let output = source.next_unit();
                    (Some(output), frame.goal(output))
                }
            };
            self.upcoming.push_back(FutureGoal {
                number,
                output,
                goal,
            });
            number += u64::from(!self.is_floating);
        }
    }
}

/// Returns the standard deviations of an output that is computed from a goal.
fn sd_of(frame: &Frame, goal: &ReachedGoal) -> [f64; 2] {
    [frame.first, frame.second].map(|axis| goal.sd / axis.norm())
}

impl<F: Finder> Predictor for KeyHunter<F> {
    fn observe(&mut self, moment: &Moment<'_>) {
        self.pace.observe(moment);
        if let Some(seen) = moment.look.seen {
            let from = self.last.unwrap_or(seen.position);
            self.last = Some(seen.position);
            if !self.begun {
                self.begun = true;
                self.begin_at_fixed(seen.position);
                if moment.look.time <= START_S {
                    self.begin_at_start();
                }
            }
            self.keep_pace(from, seen.position, seen.sigma);
        } else {
            self.last = None;
        }
        let Some(goal) = moment.goal else { return };
        self.goals = self.goals.saturating_add(1);
        if self.source.is_some() {
            self.follow(goal.point, moment.goals_lost);
        } else {
            self.hunt(&goal, moment.goals_lost);
            self.claim();
        }
    }

    fn predict(&self, horizon: f64, _: &Moment<'_>) -> Option<Point2<f64>> {
        self.source.as_ref()?;
        let (from, length) = self.pace.way(horizon)?;
        along(from, self.upcoming(), length)
    }

    fn goals_observed(&self) -> u32 {
        self.goals
    }

    fn key_recovered(&self) -> bool {
        self.source.is_some()
    }
}
