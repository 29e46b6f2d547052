//! Whoever knows how goals are made from a generator's outputs can undo that, find the generator's
//! state, and foretell every goal that follows: the attack on linear and on polynomial maps.

use std::collections::VecDeque;

use generators::{AnySource, Source as _};
use nalgebra::Point2;

use super::Predictor;
use crate::layout::{Layout, Slot};
use crate::moment::Moment;
use crate::travel::{Pace, along};

/// Goals that may be overlooked between two that are made out.
const OVERLOOKED: u64 = 3;
/// Goals that fit nowhere, one after the other, until the search begins anew.
const STRANGERS: u32 = 3;
/// The same when the key has been found: until it is given up.
const STRANGERS_TO_KEY: u32 = 12;
/// Goals that are computed ahead.
const AHEAD: usize = 64;
/// An output that is foretold worse than this, as a share of the square, is not foretold.
const VAGUE: f64 = 0.35;

/// Finds the state of a generator from its noisy outputs in the unit square.
pub trait Finder {
    /// Takes up the next output.
    fn observe(&mut self, output: [f64; 2]);

    /// Passes over an output that was not made out.
    fn gap(&mut self);

    /// Forgets all outputs.
    fn reset(&mut self);

    /// The generator after the last output taken up or passed over; `None` while its state is not
    /// known.
    fn source(&self) -> Option<AnySource>;

    /// The output that follows, as far as a noisy one tells.
    fn step(&self, output: [f64; 2]) -> [f64; 2];

    /// Distance of two outputs; no step makes errors grow by more than [`Finder::growth`] in it.
    fn distance(&self, a: [f64; 2], b: [f64; 2]) -> f64;

    /// By what factor a step makes errors grow.
    fn growth(&self) -> f64;
}

/// Finds the key of a robot's goals and goes on with them.
#[derive(Debug, Clone)]
pub struct KeyHunter<F> {
    layout: Layout,
    finder: F,
    /// Greatest error of a goal that is made out [m].
    goal_error: f64,
    pace: Pace,
    goals: u32,
    /// Number of the last goal that was made out.
    at: Option<u64>,
    /// The last output, and outputs passed over since.
    last: Option<([f64; 2], u32)>,
    strangers: u32,
    begun: bool,
    /// The goals to come, once the key is known, and the generator that makes more.
    upcoming: VecDeque<(u64, Point2<f64>)>,
    source: Option<AnySource>,
}

impl<F: Finder> KeyHunter<F> {
    /// For goals of this layout, made out with errors up to `goal_error` [m], > 0.
    pub fn new(layout: Layout, finder: F, goal_error: f64) -> Self {
        Self {
            layout,
            finder,
            goal_error,
            pace: Pace::default(),
            goals: 0,
            at: None,
            last: None,
            strangers: 0,
            begun: false,
            upcoming: VecDeque::new(),
            source: None,
        }
    }

    /// The goals to come, nearest first; none while the key is not known.
    pub fn upcoming(&self) -> impl Iterator<Item = Point2<f64>> + '_ {
        self.upcoming.iter().map(|(_, goal)| *goal)
    }

    fn forget(&mut self) {
        self.finder.reset();
        self.at = None;
        self.last = None;
        self.strangers = 0;
        self.upcoming.clear();
        self.source = None;
    }

    fn begin_at_fixed(&mut self, place: Point2<f64>) {
        self.forget();
        self.at = self.layout.fixed_near(place, 2.0 * self.goal_error);
    }

    /// A goal before the key is known.
    fn hunt(&mut self, goal: Point2<f64>) {
        let Some(at) = self.at else {
            if self.layout.is_uniform() {
                self.forget();
                self.at = Some(0);
                self.take_drawn(goal, 0);
            } else {
                self.begin_at_fixed(goal);
            }
            return;
        };
        let mut passed = 0;
        for number in at + 1..=at + 1 + OVERLOOKED {
            if self.fits(goal, number, passed) {
                for _ in 0..passed {
                    self.finder.gap();
                }
                if let Some((_, since)) = &mut self.last {
                    *since += passed;
                }
                self.at = Some(number);
                self.strangers = 0;
                self.take_drawn(goal, number);
                return;
            }
            passed += u32::from(matches!(self.layout.slot(number), Slot::Drawn(_)));
        }
        self.strangers += 1;
        if self.strangers >= STRANGERS {
            self.begin_at_fixed(goal);
        }
    }

    /// Feeds a goal to the search if it was drawn.
    fn take_drawn(&mut self, goal: Point2<f64>, number: u64) {
        if let Slot::Drawn(frame) = self.layout.slot(number)
            && let Some(output) = frame.output(goal)
        {
            self.finder.observe(output);
            self.last = Some((output, 0));
        }
    }

    /// Whether a goal can be the one with this number, with `passed` drawn ones before it overlooked.
    fn fits(&self, goal: Point2<f64>, number: u64, passed: u32) -> bool {
        let frame = match self.layout.slot(number) {
            Slot::Fixed(point) => return (goal - point).norm() <= 2.0 * self.goal_error,
            Slot::Drawn(frame) => frame,
        };
        let Some(output) = frame.output(goal) else {
            return false;
        };
        let side = frame.first.norm().min(frame.second.norm());
        let error = self.goal_error / side;
        let inside = output.iter().all(|c| (-error..=1.0 + error).contains(c));
        let Some((before, since)) = self.last else {
            return inside && passed == 0;
        };
        let steps = since + passed + 1;
        let grown = (0..steps).fold(error, |error, _| error * self.finder.growth());
        if grown + error > VAGUE {
            return inside && passed == 0;
        }
        let foretold = (0..steps).fold(before, |output, _| self.finder.step(output));
        inside && self.finder.distance(foretold, output) <= grown + error
    }

    /// A goal now that the key is known: which of the goals to come it is.
    fn follow(&mut self, goal: Point2<f64>, lost: bool) {
        let window = if lost || self.strangers >= STRANGERS {
            AHEAD
        } else {
            1 + OVERLOOKED as usize
        };
        let found = self
            .upcoming
            .iter()
            .take(window)
            .position(|(_, point)| (goal - point).norm() <= 2.0 * self.goal_error);
        if let Some(found) = found {
            self.upcoming.drain(..=found);
            self.strangers = 0;
            return;
        }
        self.strangers += 1;
        if self.strangers >= STRANGERS_TO_KEY {
            self.begin_at_fixed(goal);
        }
    }

    /// Computes goals ahead, if the key is known.
    fn look_ahead(&mut self) {
        if self.source.is_none()
            && let Some(source) = self.finder.source()
        {
            self.source = Some(source);
            self.strangers = 0;
        }
        let Some(source) = &mut self.source else {
            return;
        };
        while self.upcoming.len() < AHEAD {
            let last = self.upcoming.back().map(|(number, _)| *number).or(self.at);
            let number = last.map_or(0, |last| last + 1);
            let goal = match self.layout.slot(number) {
                Slot::Fixed(point) => point,
                Slot::Drawn(frame) => frame.goal(source.next_unit()),
            };
            self.upcoming.push_back((number, goal));
        }
        self.at = self
            .upcoming
            .front()
            .map(|(number, _)| number.saturating_sub(1));
    }
}

impl<F: Finder> Predictor for KeyHunter<F> {
    fn observe(&mut self, moment: &Moment<'_>) {
        self.pace.observe(moment);
        if !self.begun
            && let Some(seen) = moment.look.seen
        {
            // Patrols begin at a fixed goal more often than not.
            self.begun = true;
            self.begin_at_fixed(seen.position);
        }
        let known = self.source.is_some();
        if moment.goals_lost && !known {
            self.forget();
        }
        let Some(goal) = moment.goal else { return };
        self.goals = self.goals.saturating_add(1);
        if known {
            self.follow(goal.point, moment.goals_lost);
        } else {
            self.hunt(goal.point);
        }
        self.look_ahead();
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
