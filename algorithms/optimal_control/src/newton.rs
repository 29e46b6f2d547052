//! The linear system of a step: derivatives of the Lagrangian and of the barrier.

use nalgebra::SMatrix;

use crate::errors::Errors;
use crate::interior_point::InteriorPoint;
use crate::riccati::{BOTH, End, Point, STATES, State};
use crate::variables::{OMEGA, Q, TIME};

/// Weight of the conditions of the last state in the augmented Lagrangian.
pub const END_WEIGHT: f64 = 1e4;
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
            let of = problem.stage_rows(k);
            let pairs = self.at.slack[of.clone()]
                .iter()
                .zip(&self.at.dual[of.clone()]);
            for (row, (slack, dual)) in self.values.rows[of].iter().zip(pairs) {
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
        for (inverse, slack) in self.inverse.iter_mut().zip(&self.at.slack) {
            *inverse = 1.0 / slack;
        }
        let mut stages = core::mem::take(&mut self.stages);
        for (k, stage) in stages.iter_mut().enumerate() {
            stage.gradient = Point::zeros();
            stage.gradient[turning] = cost * self.at.component(k, turning);
            stage.hessian[(turning, turning)] += cost;
            self.add_rows(k, barrier, &mut stage.hessian, &mut stage.gradient);
        }
        self.stages = stages;
        let (mut hessian, mut gradient) = (SMatrix::zeros(), Point::zeros());
        self.add_rows(problem.count, barrier, &mut hessian, &mut gradient);
        end.hessian += hessian.fixed_view::<STATES, STATES>(0, 0);
        end.gradient += gradient.fixed_rows::<STATES>(0);
        end
    }

    /// Adds the barrier of a node's rows.
    fn add_rows(
        &self,
        k: usize,
        barrier: f64,
        hessian: &mut SMatrix<f64, BOTH, BOTH>,
        gradient: &mut Point,
    ) {
        let of = self.problem.stage_rows(k);
        let slacks = self.at.slack[of.clone()]
            .iter()
            .zip(&self.inverse[of.clone()]);
        let pairs = slacks.zip(&self.at.dual[of.clone()]);
        for (row, ((slack, inverse), dual)) in self.values.rows[of].iter().zip(pairs) {
            let weight = dual * inverse;
            let force = barrier * inverse + weight * (row.value + slack);
            let ([i, j], [a, b], bend) = (row.at, row.slope, dual * row.bend);
            gradient[i] += a * force;
            hessian[(i, i)] += weight * a * a - bend * b * b;
            if i != j {
                gradient[j] += b * force;
                let mixed = (weight + bend) * a * b;
                hessian[(i, j)] += mixed;
                hessian[(j, i)] += mixed;
                hessian[(j, j)] += weight * b * b - bend * a * a;
            }
        }
    }

    /// Completes a step of states and controls by those of slacks and multipliers.
    pub(super) fn complete_step(&mut self, barrier: f64) {
        let problem = self.problem;
        for k in 0..=problem.count {
            let w = self.step.point(k);
            let of = problem.stage_rows(k);
            let steps = self.step.slack[of.clone()].iter_mut();
            let slacks = self.at.slack[of.clone()].iter();
            for ((step, slack), row) in steps.zip(slacks).zip(&self.values.rows[of]) {
                let moved = row.slope[0] * w[row.at[0]] + row.slope[1] * w[row.at[1]];
                *step = -(row.value + slack) - moved;
            }
        }
        let steps = self.step.dual.iter_mut().zip(&self.step.slack);
        let at = self.at.dual.iter().zip(&self.inverse);
        for ((to, step), (dual, inverse)) in steps.zip(at) {
            *to = (barrier - dual * step) * inverse - dual;
        }
        let last = self.at.states[problem.count] + self.step.states[problem.count];
        for (i, target) in problem.prescribed() {
            self.step.end[i] = END_WEIGHT * (last[i] - target);
        }
    }
}
