//! Return to the constraints: where no step of the barrier's problem is acceptable, the violation is
//! minimised alone, near the present trajectory, by the same recursion.

use nalgebra::SMatrix;

use crate::interior_point::InteriorPoint;
use crate::newton::END_WEIGHT;
use crate::riccati::{BOTH, End, Point, STATES, State};

/// Maximum number of steps.
const MAX_STEPS: u32 = 20;
/// Cost of a step's square in every variable.
const PROXIMAL: f64 = 1.0;
/// Cost of an inequality's violation squared.
const WEIGHT: f64 = 1e4;
/// Violation at which the return ends.
const ENOUGH: f64 = 1e-3;
/// Maximum number of times that a step is halved.
const MAX_HALVINGS: i32 = 10;

impl InteriorPoint<'_> {
    /// Reduces the violation of all constraints and centres slacks and multipliers for a barrier
    /// parameter.
    pub(super) fn restore(&mut self, barrier: f64, stop: &mut dyn FnMut() -> bool) {
        // Without slacks, the violation of an inequality is its own.
        self.at.slack.fill(0.0);
        self.step.slack.fill(0.0);
        let mut violation = self.violation_of_part(0.0);
        for _ in 0..MAX_STEPS {
            if violation <= ENOUGH || stop() {
                break;
            }
            self.evaluate();
            let end = self.assemble_violation();
            if !self.solve_system(&end, PROXIMAL) {
                break;
            }
            let reduced = (0..MAX_HALVINGS)
                .map(|halvings| self.violation_of_part(0.5f64.powi(halvings)))
                .find(|reduced| *reduced < violation);
            let Some(reduced) = reduced else { break };
            self.move_to_trial();
            violation = reduced;
        }
        self.at.costates.fill(State::zeros());
        self.at.end.fill(0.0);
        self.at.center(self.problem, barrier);
        self.merit = None;
    }

    /// Sum of the violations after a part of the step.
    fn violation_of_part(&mut self, part: f64) -> f64 {
        self.try_step(part);
        self.trial_violation()
    }

    /// Completes the stages by the squares of the violations; returns the end.
    fn assemble_violation(&mut self) -> End {
        let problem = self.problem;
        let mut end = End {
            hessian: SMatrix::zeros(),
            gradient: State::zeros(),
        };
        for (i, target) in problem.prescribed() {
            end.hessian[(i, i)] += END_WEIGHT;
            end.gradient[i] += END_WEIGHT * (self.at.states[problem.count][i] - target);
        }
        for k in 0..=problem.count {
            let mut hessian = SMatrix::<f64, BOTH, BOTH>::zeros();
            let mut gradient = Point::zeros();
            for row in self.values.rows[problem.stage_rows(k)]
                .iter()
                .filter(|row| row.value > 0.0)
            {
                for (i, a) in row.at.into_iter().zip(row.slope) {
                    gradient[i] += WEIGHT * a * row.value;
                    for (j, b) in row.at.into_iter().zip(row.slope) {
                        hessian[(i, j)] += WEIGHT * a * b;
                    }
                }
            }
            if let Some(stage) = self.stages.get_mut(k) {
                (stage.hessian, stage.gradient) = (hessian, gradient);
            } else {
                end.hessian += hessian.fixed_view::<STATES, STATES>(0, 0);
                end.gradient += gradient.fixed_rows::<STATES>(0);
            }
        }
        end
    }
}

#[cfg(test)]
mod tests {
    use geometry::shape::{Aabb, Convex};
    use nalgebra::Point2;
    use trajectory_problem::RobotLimits;

    use super::*;
    use crate::iterate::Iterate;
    use crate::problem::{KeepOutDisc, Node, Problem};
    use crate::scaled::ScaledProblem;

    #[test]
    fn restoration_reduces_the_violation() {
        let disc = Convex::disc(Point2::new(1.0, 0.1), 0.2);
        let problem = Problem {
            start: Point2::origin(),
            start_heading: 0.0,
            start_speeds: [Some(0.0), Some(0.0)],
            goal: Point2::new(2.0, 0.0),
            goal_heading: None,
            goal_speed: Some(0.0),
            limits: RobotLimits {
                acceleration: Some(0.5),
                angular_acceleration: Some(2.0),
                ..RobotLimits::simple(0.5, 1.0).forwards()
            },
            bounds: Aabb {
                min: Point2::new(-1.0, -1.0),
                max: Point2::new(3.0, 1.0),
            },
            obstacles: vec![KeepOutDisc {
                shape: &disc,
                distance: 0.1,
            }],
        };
        // Straight through the disc, faster than allowed.
        let nodes: Vec<Node> = (0..=20)
            .map(|k| Node {
                at: Point2::new(0.1 * f64::from(k), 0.0),
                theta: 0.0,
                v: 0.6,
                omega: 0.0,
            })
            .collect();
        let mut scaled = ScaledProblem::new(&problem, &nodes, 5.0);
        let mut at = Iterate::of_guess(&scaled, &problem, &nodes);
        scaled.set_rows(&at.states);
        at.center(&scaled, 1e-3);
        let mut method = InteriorPoint::new(&scaled, at);
        let violation = |method: &mut InteriorPoint<'_>| {
            method.at.slack.fill(0.0);
            method.step.slack.fill(0.0);
            method.violation_of_part(0.0)
        };
        let before = violation(&mut method);
        method.restore(1e-3, &mut || true);
        assert_eq!(violation(&mut method), before);
        method.restore(1e-3, &mut || false);
        let after = violation(&mut method);
        assert!(after < ENOUGH, "{before} {after}");
    }
}
