//! Line search with a filter: a step is accepted if it reduces the violation of the constraints or
//! the merit, against all iterates of the same barrier parameter.

use geometry::math;

use crate::interior_point::InteriorPoint;
use crate::iterate::Iterate;
use crate::riccati::STATES;
use crate::variables::TIME;

/// Maximum number of times that a step is halved.
const MAX_HALVINGS: usize = 12;
/// Minimum relative reduction of the violation, and of the merit in units of the violation.
const REDUCTION: f64 = 1e-5;
/// Violation below which a step must reduce the merit as its slope predicts.
const FEASIBLE: f64 = 1e-4;
/// Minimum share of the reduction that the slope predicts.
const ARMIJO: f64 = 1e-4;
/// Rounding of violation and merit.
const ROUNDING: f64 = 1e-13;
/// Minimum share of a slack or multiplier that a step takes away at most.
const FRACTION: f64 = 0.99;
/// Maximum ratio of a multiplier to that of the central path, and of the inverse.
const MAX_RATIO: f64 = 1e10;

impl InteriorPoint<'_> {
    /// Takes the longest acceptable part of the step; `false` if there is none.
    pub(super) fn search_line(&mut self, barrier: f64) -> bool {
        let (slack, dual) = (&self.step.slack, &self.step.dual);
        let primal = longest(slack, &self.inverse, barrier, |step, inverse| {
            step * inverse
        });
        let dual = longest(dual, &self.at.dual, barrier, |step, dual| step / dual);
        let violation = self.errors.violation;
        let merit = match self.merit {
            Some([at, merit]) if at == barrier => merit,
            _ => self.merit(&self.at, barrier),
        };
        let slope = self.merit_slope(barrier);
        let mut length = primal;
        for _ in 0..MAX_HALVINGS {
            self.try_step(length);
            let next = [self.trial_violation(), self.merit(&self.trial, barrier)];
            let descends = slope < 0.0
                && violation < FEASIBLE
                && length * math::pow(-slope, 2.3) > math::pow(violation, 1.1);
            let better = if descends {
                next[1] <= merit + ARMIJO * length * slope + ROUNDING
            } else {
                next[0] <= (1.0 - REDUCTION) * violation + ROUNDING
                    || next[1] <= merit - REDUCTION * violation
            };
            let passes = self.filter.iter().all(|f| next[0] < f[0] || next[1] < f[1]);
            if better && passes && next.iter().all(|value| value.is_finite()) {
                if !descends {
                    let (violation, margin) =
                        ((1.0 - REDUCTION) * violation, REDUCTION * violation);
                    self.filter.push([violation, merit - margin]);
                }
                self.accept(length, dual, barrier);
                self.merit = Some([barrier, next[1]]);
                return true;
            }
            length *= 0.5;
        }
        false
    }

    fn end_violation(&self, at: &Iterate) -> f64 {
        let last = &at.states[self.problem.count];
        let prescribed = self.problem.prescribed();
        prescribed.map(|(i, target)| (last[i] - target).abs()).sum()
    }

    pub(super) fn try_step(&mut self, length: f64) {
        let (at, step, trial) = (&self.at, &self.step, &mut self.trial);
        for ((to, from), by) in trial.states.iter_mut().zip(&at.states).zip(&step.states) {
            *to = from + by * length;
        }
        for ((to, from), by) in trial
            .controls
            .iter_mut()
            .zip(&at.controls)
            .zip(&step.controls)
        {
            *to = from + by * length;
        }
        for ((to, from), by) in trial.slack.iter_mut().zip(&at.slack).zip(&step.slack) {
            *to = from + by * length;
        }
    }

    /// Sum of the violations at the trial; slacks that are smaller than their rows allow grow.
    pub(super) fn trial_violation(&mut self) -> f64 {
        let problem = self.problem;
        let mut sum = self.end_violation(&self.trial);
        for k in 0..=problem.count {
            let w = self.trial.point(k);
            let of = problem.stage_rows(k);
            let slacks = self.trial.slack[of.clone()].iter_mut();
            let values = self.trial_values.rows[of.clone()].iter_mut();
            for ((row, slack), to) in problem.rows[of].iter().zip(slacks).zip(values) {
                row.evaluate(&w, &problem.obstacles, to);
                *slack = slack.max(-to.value);
                sum += to.value + *slack;
            }
            if k < problem.count {
                let headings = problem.motion.headings(&w);
                let defect = problem.motion.next(&w, &headings) - self.trial.states[k + 1];
                self.trial_values.headings[k] = headings;
                sum += defect.lp_norm(1);
            }
        }
        sum
    }

    /// Duration, cost of turning and barrier.
    fn merit(&self, at: &Iterate, barrier: f64) -> f64 {
        let (cost, turning) = (self.turning_cost(), self.turning());
        let mut sum = at.states[self.problem.count][TIME];
        for k in 0..self.problem.count {
            let rate = at.component(k, turning);
            sum += 0.5 * cost * rate * rate;
        }
        // Fewer logarithms: of products of slacks.
        for slacks in at.slack.chunks(16) {
            sum -= barrier * math::ln(slacks.iter().product());
        }
        sum
    }

    /// Derivative of the merit along the step.
    fn merit_slope(&self, barrier: f64) -> f64 {
        let (cost, turning) = (self.turning_cost(), self.turning());
        let mut sum = self.step.states[self.problem.count][TIME];
        for k in 0..self.problem.count {
            sum += cost * self.at.component(k, turning) * self.step.component(k, turning);
        }
        let pairs = self.inverse.iter().zip(&self.step.slack);
        sum - barrier * pairs.map(|(inverse, step)| inverse * step).sum::<f64>()
    }

    fn accept(&mut self, primal: f64, dual: f64, barrier: f64) {
        self.move_to_trial();
        let (at, step) = (&mut self.at, &self.step);
        core::mem::swap(&mut at.slack, &mut self.trial.slack);
        for (costate, new) in at.costates.iter_mut().zip(&step.costates) {
            *costate += (new - *costate) * primal;
        }
        at.end += step.end * primal;
        for ((value, by), slack) in at.dual.iter_mut().zip(&step.dual).zip(&at.slack) {
            let central = barrier / slack;
            *value = (*value + by * dual).clamp(central / MAX_RATIO, central * MAX_RATIO);
        }
    }
}

impl Iterate {
    /// A component of w.
    pub(super) fn component(&self, k: usize, i: usize) -> f64 {
        if i < STATES {
            self.states[k][i]
        } else {
            self.controls[k][i - STATES]
        }
    }
}

/// The longest part of a step, at most 1, that leaves a share of positive values; `change` is the part of
/// a value by which the whole step changes it.
fn longest(steps: &[f64], values: &[f64], barrier: f64, change: impl Fn(f64, f64) -> f64) -> f64 {
    let fraction = (1.0 - barrier).max(FRACTION);
    // Lanes do not wait for each other.
    let mut most = [0.0; 4];
    for (steps, values) in steps.chunks(most.len()).zip(values.chunks(most.len())) {
        for (most, (step, value)) in most.iter_mut().zip(steps.iter().zip(values)) {
            let shrunk = -change(*step, *value);
            *most = if shrunk > *most { shrunk } else { *most };
        }
    }
    let most = most.into_iter().fold(fraction, f64::max);
    fraction / most
}
