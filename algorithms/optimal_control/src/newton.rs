//! The linear system of a step: derivatives of the Lagrangian and of the barrier.

use nalgebra::SMatrix;

use crate::errors::Errors;
use crate::interior_point::InteriorPoint;
use crate::riccati::{End, Point, STATES, State};
use crate::rows::{OMEGA, Q, TIME};

/// Weight of the conditions of the last state in the augmented Lagrangian.
pub(super) const END_WEIGHT: f64 = 1e4;
/// Cost of the turning rate's square, in units of its limit's, relative to that of time: it selects
/// the smoothest of the fastest motions, and costs less than half this share of the duration.
const TURNING_COST: f64 = 2e-4;

impl InteriorPoint<'_> {
    /// Second derivative of the cost of turning in a stage.
    pub(super) fn turning_cost(&self) -> f64 {
        TURNING_COST / self.problem.count as f64
    }

    /// Index of a stage's turning rate in w.
    pub(super) fn turning(&self) -> usize {
        if self.problem.motion.steps { Q } else { OMEGA }
    }

    /// Evaluates the motion with its derivatives, and the errors.
    pub(super) fn evaluate(&mut self) {
        let problem = self.problem;
        let (cost, turning) = (self.turning_cost(), self.turning());
        let mut errors = Errors::none();
        for k in 0..=problem.count {
            let w = self.at.point(k);
            let mut gradient = Point::zeros();
            if let Some(stage) = self.stages.get_mut(k) {
                let costate = &self.at.costates[k + 1];
                let next = &self.at.states[k + 1];
                let headings = &self.values.headings[k];
                problem.motion.linearise(&w, headings, costate, next, stage);
                gradient += Point::from(stage.motion.transposed(&costate.data.0[0]));
                gradient[turning] += cost * w[turning];
                stage
                    .defect
                    .iter()
                    .for_each(|&defect| errors.add_constraint(defect));
            } else {
                gradient[TIME] += 1.0;
                for (i, target) in problem.prescribed() {
                    gradient[i] += self.at.end[i];
                    errors.add_constraint(self.at.states[k][i] - target);
                }
            }
            for n in problem.of(k) {
                let row = &self.values.rows[n];
                let (slack, dual) = (self.at.slack[n], self.at.dual[n]);
                errors.add_product(slack * dual);
                errors.add_constraint(row.value + slack);
                gradient[row.at[0]] += row.slope[0] * dual;
                gradient[row.at[1]] += row.slope[1] * dual;
            }
            for i in 0..STATES {
                if k > 0 {
                    gradient[i] -= self.at.costates[k][i];
                } else if !problem.free[i] {
                    gradient[i] = 0.0;
                }
            }
            errors.add_gradient(gradient.amax());
        }
        self.errors = errors;
    }

    /// Completes the stages by the cost and the barrier; returns the end.
    pub(super) fn assemble(&mut self, barrier: f64) -> End {
        let problem = self.problem;
        let (cost, turning) = (self.turning_cost(), self.turning());
        let mut end = End {
            hessian: SMatrix::zeros(),
            gradient: State::zeros(),
        };
        end.gradient[TIME] = 1.0;
        let last = &self.at.states[problem.count];
        for (i, target) in problem.prescribed() {
            end.hessian[(i, i)] += END_WEIGHT;
            end.gradient[i] += self.at.end[i] + END_WEIGHT * (last[i] - target);
        }
        for k in 0..=problem.count {
            let mut gradient = Point::zeros();
            if let Some(stage) = self.stages.get_mut(k) {
                stage.hessian[(turning, turning)] += cost;
                gradient[turning] = cost * self.at.point(k)[turning];
            }
            for n in problem.of(k) {
                let row = &self.values.rows[n];
                let (slack, dual) = (self.at.slack[n], self.at.dual[n]);
                let weight = dual / slack;
                let force = barrier / slack + weight * (row.value + slack);
                let ([i, j], [a, b], bend) = (row.at, row.slope, dual * row.bend);
                gradient[i] += a * force;
                gradient[j] += b * force;
                let mut add = |at: (usize, usize), value: f64| match self.stages.get_mut(k) {
                    Some(stage) => stage.hessian[at] += value,
                    None => end.hessian[at] += value,
                };
                add((i, i), weight * a * a - bend * b * b);
                if i != j {
                    add((i, j), (weight + bend) * a * b);
                    add((j, i), (weight + bend) * a * b);
                    add((j, j), weight * b * b - bend * a * a);
                }
            }
            match self.stages.get_mut(k) {
                Some(stage) => stage.gradient = gradient,
                None => end.gradient += gradient.fixed_rows::<STATES>(0),
            }
        }
        end
    }

    /// Completes a step of states and controls by those of slacks and multipliers.
    pub(super) fn complete_step(&mut self, barrier: f64) {
        let problem = self.problem;
        for k in 0..=problem.count {
            let w = self.step.point(k);
            for n in problem.of(k) {
                let row = &self.values.rows[n];
                let (slack, dual) = (self.at.slack[n], self.at.dual[n]);
                let moved = row.slope[0] * w[row.at[0]] + row.slope[1] * w[row.at[1]];
                let step = -(row.value + slack) - moved;
                self.step.slack[n] = step;
                self.step.dual[n] = (barrier - slack * dual - dual * step) / slack;
            }
        }
        let last = self.at.states[problem.count] + self.step.states[problem.count];
        for (i, target) in problem.prescribed() {
            self.step.end[i] = END_WEIGHT * (last[i] - target);
        }
    }
}
