//! Search for a local optimum from a guess, on ever more stages.

use nalgebra::Vector2;

use crate::interior_point::{InteriorPoint, Outcome};
use crate::iterate::Iterate;
use crate::problem::{Node, Problem};
use crate::riccati::BOTH;
use crate::scaled::ScaledProblem;
use crate::variables::{OMEGA, THETA, TIME, V};

/// Number of stages of a guess that suffices where no obstacle is smaller than a stage.
pub const COARSE: usize = 20;
/// Minimum number of stages of a result: [`COARSE`], doubled three times.
const FINE: usize = 160;
/// Maximum number of stages of a guess.
pub const MAX_STAGES: usize = 640;
/// Barrier parameters: for a guess, up to the last doubling of its stages, and from there on.
const BARRIER: [f64; 3] = [1e-3, 1e-5, 3e-8];

/// Residual on fewer stages above which a search has failed.
const UNSOLVED: f64 = 1e-2;
/// Maximum number of times that a coarse search which has gone far from its guess continues with the obstacles there.
const MAX_DEPARTURES: u32 = 2;

/// A trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Poses and speeds at the nodes, evenly spaced in time. Speeds change linearly between them, or
    /// are constant after each node if `steps`; the last node then has those of the last stage.
    pub nodes: Vec<Node>,
    /// `true` if speeds step at nodes.
    pub steps: bool,
    /// Duration (s).
    pub duration: f64,
}

/// A search.
#[derive(Debug, Clone)]
pub struct Search<'a> {
    problem: &'a Problem<'a>,
    scaled: ScaledProblem,
    at: Iterate,
    /// Barrier parameter at the beginning of the next run.
    barrier: f64,
}

impl<'a> Search<'a> {
    /// Begins at a guess: nodes evenly spaced in time over a duration (s). It need not satisfy any
    /// condition. `None` if it has fewer than two nodes or no duration.
    pub fn new(problem: &'a Problem<'a>, guess: &[Node], duration: f64) -> Option<Self> {
        if guess.len() < 2 || !(duration > 0.0 && duration.is_finite()) {
            return None;
        }
        let mut scaled = ScaledProblem::new(problem, guess, duration);
        let mut at = Iterate::of_guess(&scaled, problem, guess);
        scaled.set_rows(&at.states);
        at.center(&scaled, BARRIER[0]);
        Some(Self {
            problem,
            scaled,
            at,
            barrier: BARRIER[0],
        })
    }

    /// Searches with the guess's number of stages, only to the precision that a choice among
    /// searches needs. `stop` is called in every iteration with the number of inequalities and variables, and ends the
    /// search by `true`.
    pub fn run_coarse(&mut self, stop: &mut dyn FnMut(usize) -> bool) -> Outcome {
        let mut outcome = self.iterate(BARRIER[1], stop);
        for _ in 0..MAX_DEPARTURES {
            let is_solved = !outcome.stopped && outcome.residual <= UNSOLVED;
            if !is_solved || !self.scaled.lacks_rows(&self.at.states) {
                break;
            }
            self.barrier = BARRIER[0];
            let old = self.scaled.clone();
            self.follow(&old);
            outcome = self.iterate(BARRIER[1], stop);
        }
        outcome
    }

    /// Searches until there are at least eight times [`COARSE`] stages; `stop` is called in every iteration
    /// with the number of inequalities and variables, and ends the search by `true`.
    pub fn run(&mut self, stop: &mut dyn FnMut(usize) -> bool) -> Outcome {
        loop {
            let last = if self.scaled.count >= FINE {
                BARRIER[2]
            } else {
                BARRIER[1]
            };
            let outcome = self.iterate(last, stop);
            if last == BARRIER[2] || outcome.stopped || outcome.residual > UNSOLVED {
                return outcome;
            }
            self.double();
        }
    }

    /// Lets an obstacle grow by a distance (m) for the next run.
    pub fn grow(&mut self, obstacle: usize, by: f64) {
        if let Some(obstacle) = self.scaled.obstacles.get_mut(obstacle) {
            obstacle.grow(by / self.scaled.length);
        }
    }

    /// Number of stages.
    pub fn stages(&self) -> usize {
        self.scaled.count
    }

    /// Duration (s) of the present trajectory.
    pub fn duration(&self) -> f64 {
        self.at.states[0][TIME] * self.scaled.duration
    }

    /// Largest distance (m) of two present trajectories at the same parts of their durations, at the
    /// nodes of the one with fewer stages.
    pub fn distance(&self, other: &Self) -> f64 {
        let count = self.scaled.count.min(other.scaled.count);
        let at = |search: &Self, k: usize| {
            search.at.position(k * search.scaled.count / count) * search.scaled.length
        };
        (0..=count).fold(0.0, |most: f64, k| {
            most.max((at(self, k) - at(other, k)).norm())
        })
    }

    /// The present trajectory.
    pub fn solution(&self) -> Solution {
        let scaled = &self.scaled;
        let steps = scaled.motion.steps;
        let (slowest, fastest) = (self.problem.limits.v_min, self.problem.limits.v_max);
        let node = |k: usize| {
            let speeds = &self.at.states[if steps { (k + 1).min(scaled.count) } else { k }];
            let at: Vector2<f64> = self.at.position(k);
            Node {
                at: scaled.origin + at * scaled.length,
                theta: self.at.states[k][THETA],
                // Rounding beyond the limit would be a robot that reverses.
                v: (speeds[V] * scaled.v).clamp(slowest, fastest),
                omega: speeds[OMEGA] * scaled.omega,
            }
        };
        Solution {
            nodes: (0..=scaled.count).map(node).collect(),
            steps,
            duration: self.duration(),
        }
    }

    /// Iterates to a barrier parameter, with the rows near the present trajectory.
    fn iterate(&mut self, last: f64, stop: &mut dyn FnMut(usize) -> bool) -> Outcome {
        if self.barrier < BARRIER[0] {
            let old = self.scaled.clone();
            self.follow(&old);
        }
        let size = self.scaled.rows.len() + BOTH * self.scaled.count;
        let mut method = InteriorPoint::new(&self.scaled, core::mem::take(&mut self.at));
        let outcome = method.run([self.barrier.max(last), last], &mut || stop(size));
        self.at = method.into_iterate();
        self.barrier = last;
        outcome
    }

    /// Continues on twice as many stages.
    fn double(&mut self) {
        let mut fine = self.scaled.clone();
        fine.set_count(2 * fine.count, &self.problem.limits);
        let dual = core::mem::take(&mut self.at.dual);
        let mut at = self.at.doubled(&self.scaled, &fine);
        at.dual = dual;
        self.at = at;
        let old = core::mem::replace(&mut self.scaled, fine);
        if self.scaled.count >= FINE {
            self.barrier = BARRIER[2];
        }
        self.follow(&old);
    }

    /// Sets the rows near the present trajectory, with the multipliers of the old ones.
    fn follow(&mut self, old: &ScaledProblem) {
        self.scaled.set_rows(&self.at.states);
        let dual = core::mem::take(&mut self.at.dual);
        self.at.transfer(&dual, old, &self.scaled);
        self.at.carry(&self.scaled, self.barrier);
    }
}
