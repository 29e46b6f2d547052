//! Primal–dual interior-point iteration.
//!
//! After A. Wächter, L. T. Biegler, *On the implementation of an interior-point filter line-search
//! algorithm for large-scale nonlinear programming*, Mathematical Programming 106 (2006), 25–57, with
//! its linear systems solved by a Riccati recursion, as by L. Vanroye, A. Sathya, J. De Schutter, W.
//! Decré, *FATROP: A Fast Constrained Optimal Control Problem Solver for Robot Trajectory
//! Optimization and Control* (2023). The conditions of the last state are in an augmented Lagrangian,
//! so that the recursion has no constraints.

use crate::errors::Errors;
use crate::iterate::Iterate;
use crate::motion::Headings;
use crate::riccati::{End, Riccati, Stage, Unknowns};
use crate::rows::RowDerivatives;
use crate::scaled::ScaledProblem;

/// A problem of the barrier counts as solved at this multiple of the barrier parameter.
const SUBPROBLEM: f64 = 10.0;
/// Maximum number of linear systems.
const MAX_SYSTEMS: u32 = 300;
/// Errors of the first-order conditions below which a solution is a local optimum.
const OPTIMAL: f64 = 1e-6;
/// Shifts of the Hessians: the first, growth per attempt, reduction after success, maximum.
const SHIFT: [f64; 4] = [1e-6, 8.0, 3.0, 1e6];
/// Number of shifted steps in succession after which the next begins with the last shift.
const SHIFTED: u32 = 3;
/// Barrier parameter after a return to the constraints.
const RESTORED: f64 = 1e-3;

/// Convergence of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Largest error of the first-order conditions (stationarity, constraints, complementarity), in
    /// scaled units, where times are parts of the duration.
    pub residual: f64,
    /// `true` if it was stopped.
    pub stopped: bool,
}

impl Outcome {
    /// Returns `true` if the solution satisfies the first-order conditions of a local optimum.
    pub fn is_optimal(&self) -> bool {
        self.residual <= OPTIMAL
    }
}

/// Headings and rows at an iterate's states and controls, which the line search leaves to the next step.
#[derive(Debug, Clone)]
pub struct Values {
    /// Headings in each stage.
    pub headings: Vec<Headings>,
    /// Each row.
    pub rows: Vec<RowDerivatives>,
}

/// The iteration and its memory.
pub struct InteriorPoint<'a> {
    pub(super) problem: &'a ScaledProblem,
    pub(super) at: Iterate,
    /// The step, and the iterate that it leads to. Costates are new values, not changes.
    pub(super) step: Iterate,
    pub(super) trial: Iterate,
    pub(super) stages: Vec<Stage>,
    /// Values at the iterate, and at the trial.
    pub(super) values: Values,
    pub(super) trial_values: Values,
    /// Inverse of each slack.
    pub(super) inverse: Vec<f64>,
    /// Errors at the iterate.
    pub(super) errors: Errors,
    /// A barrier parameter, and the merit of the iterate with it, if known.
    pub(super) merit: Option<[f64; 2]>,
    /// Pairs of violation and merit that no later iterate may both exceed.
    pub(super) filter: Vec<[f64; 2]>,
    riccati: Riccati,
    /// Number of linear systems of this run.
    systems: u32,
    /// The last shift that was needed, and the number of steps in succession that needed one.
    shift: f64,
    shifted: u32,
}

impl<'a> InteriorPoint<'a> {
    /// Begins at an iterate with slacks and multipliers.
    pub fn new(problem: &'a ScaledProblem, at: Iterate) -> Self {
        let values = Values {
            headings: vec![Headings::default(); problem.count],
            rows: problem.rows.iter().map(RowDerivatives::from_row).collect(),
        };
        let mut method = Self {
            stages: vec![Stage::default(); problem.count],
            inverse: vec![0.0; problem.rows.len()],
            trial_values: values.clone(),
            values,
            riccati: Riccati::new(problem.count),
            step: at.clone(),
            // A trial has no multipliers.
            trial: Iterate {
                states: at.states.clone(),
                controls: at.controls.clone(),
                slack: at.slack.clone(),
                ..Iterate::default()
            },
            errors: Errors::none(),
            merit: None,
            // A step adds one pair at most.
            filter: Vec::with_capacity(MAX_SYSTEMS as usize),
            shift: 0.0,
            shifted: 0,
            systems: 0,
            problem,
            at,
        };
        method.try_step(0.0);
        method.trial_violation();
        method.move_to_trial();
        method
    }

    /// Makes the trial's states and controls the iterate's.
    pub(super) fn move_to_trial(&mut self) {
        core::mem::swap(&mut self.at.states, &mut self.trial.states);
        core::mem::swap(&mut self.at.controls, &mut self.trial.controls);
        core::mem::swap(&mut self.values, &mut self.trial_values);
    }

    /// The iterate.
    pub fn into_iterate(self) -> Iterate {
        self.at
    }

    /// Reduces the barrier parameter from the first value to the last. `stop` is called in every
    /// iteration and ends it by `true`.
    pub fn run(&mut self, barrier: [f64; 2], stop: &mut dyn FnMut() -> bool) -> Outcome {
        let [mut barrier, last] = barrier;
        let mut before: Option<(f64, Iterate)> = None;
        self.filter.clear();
        self.systems = 0;
        loop {
            self.evaluate();
            let mut residual = self.errors.residual(barrier);
            while residual <= SUBPROBLEM * barrier && barrier > last {
                barrier = (0.2 * barrier).min(barrier * barrier.sqrt()).max(last);
                self.filter.clear();
                residual = self.errors.residual(barrier);
            }
            let solved = residual <= SUBPROBLEM * last && barrier <= last;
            let stopped = !solved && stop();
            let mut ends = solved || stopped || self.systems >= MAX_SYSTEMS;
            if !ends && !self.advance(barrier, stop) {
                ends = before.is_some();
                if !ends {
                    before = Some((self.errors.residual(0.0), self.at.clone()));
                    barrier = barrier.max(RESTORED);
                    self.restore(barrier, stop);
                    self.filter.clear();
                }
            }
            if ends {
                let mut residual = self.errors.residual(0.0);
                if let Some(before) = before
                    && before.0 < residual
                {
                    (residual, self.at) = before;
                }
                return Outcome { residual, stopped };
            }
        }
    }

    /// Takes a step; `false` if there is none. Where the step of the Hessian does not exist or
    /// does not lead anywhere, the Hessian is shifted: shorter steps, nearer to the gradient.
    fn advance(&mut self, barrier: f64, stop: &mut dyn FnMut() -> bool) -> bool {
        let [first, growth, reduction, most] = SHIFT;
        let end = self.assemble(barrier);
        let mut shift = if self.shifted < SHIFTED {
            0.0
        } else {
            self.shift / growth
        };
        while shift <= most {
            if self.solve_system(&end, shift) {
                self.complete_step(barrier);
                if self.search_line(barrier) {
                    self.shifted = if shift > first { self.shifted + 1 } else { 0 };
                    if shift > 0.0 {
                        self.shift = shift;
                    }
                    return true;
                }
            }
            // Each further system is as much work as an iteration.
            if stop() {
                return false;
            }
            shift = if shift == 0.0 {
                (self.shift / reduction).max(first)
            } else {
                shift * growth
            };
        }
        false
    }

    /// Computes the step of states and controls; `false` if it is not a minimum.
    pub(super) fn solve_system(&mut self, end: &End, shift: f64) -> bool {
        self.systems += 1;
        let step = &mut self.step;
        let mut to = Unknowns {
            states: &mut step.states,
            controls: &mut step.controls,
            costates: &mut step.costates,
        };
        let free = self.problem.free;
        let solved = self.riccati.solve(&self.stages, end, free, shift, &mut to);
        solved.is_ok()
    }
}
