//! The potential-field evader as a controller of a policy, whose actions tune or correct it.

use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use pursuit_evasion::potential_evader::{Evader, EvaderParams};
use robot::spec::RobotModel;
use robot::team::Role;

use crate::action::{ACTION_LENGTH, ActionKind, action, command};
use crate::error::LayoutError;
use crate::facts::RobotFacts;

/// Robot that [`Evader`] steers in every tick, as the last action changes it; before the first one, with the default
/// parameters.
#[derive(Debug, Clone)]
pub struct FieldEvader {
    evader: Evader,
    model: RobotModel,
    kind: ActionKind,
    correction: [f32; ACTION_LENGTH],
}

impl FieldEvader {
    /// Creates the controller of the robot with index `me`. Actions of the kind [`ActionKind::Twist`] do not change it.
    ///
    /// # Errors
    /// [`LayoutError::NoEvader`] for a robot of another role.
    pub fn new(kind: ActionKind, own: &RobotFacts, me: usize) -> Result<Self, LayoutError> {
        let model = own.model;
        let limits = Limits::new(model.v_max, model.v_reverse_max, model.omega_max).ok();
        let limits = limits.filter(|_| own.team.role == Role::Evader);
        let evader =
            limits.and_then(|limits| Evader::new(EvaderParams::default(), limits, me as u64).ok());
        Ok(Self {
            evader: evader.ok_or_else(|| LayoutError::NoEvader {
                robot: own.name.clone(),
            })?,
            model,
            kind,
            correction: [0.0; ACTION_LENGTH],
        })
    }

    /// Takes an action, until the next one.
    ///
    /// With [`ActionKind::Tune`], its numbers are for the parameters `avoid.speed`, the maximum repulsion of other robots,
    /// and `threat.gain`, the extra cost of paths that pass the Police. A number `a` sets (5 + 3 a) / (5 − 3 a) times the
    /// default value. With [`ActionKind::Residual`], they are added to the action of the controller; the sum is clamped to
    /// −1..1.
    pub fn act(&mut self, action: [f32; ACTION_LENGTH]) {
        match self.kind {
            ActionKind::Twist => {}
            ActionKind::Tune => {
                let [speed, gain] = action.map(factor);
                let mut params = EvaderParams::default();
                params.avoid.speed *= speed;
                params.threat.gain *= gain;
                let valid = self.evader.set_params(params);
                debug_assert!(valid.is_ok(), "{valid:?}");
            }
            ActionKind::Residual => self.correction = action,
        }
    }

    /// Returns the steering of this tick.
    pub fn steering(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        let mut steering = self.evader.command(map, view);
        // Without a correction, the command keeps all its digits.
        if self.correction != [0.0; ACTION_LENGTH] {
            let [speed, turn] = action(steering.command, &self.model);
            let [more_speed, more_turn] = self.correction;
            steering.command = command([speed + more_speed, turn + more_turn], &self.model);
        }
        steering
    }
}

/// Returns the factor of a parameter for a number of an action: ¼ for −1, 1 for 0, 4 for 1. Opposite numbers have inverse
/// factors. Numbers beyond ±1 are clamped; NaN is 0.
fn factor(number: f32) -> f64 {
    let number = f64::from(number).clamp(-1.0, 1.0);
    if number.is_nan() {
        1.0
    } else {
        (5.0 + 3.0 * number) / (5.0 - 3.0 * number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opposite_numbers_have_inverse_factors_from_a_quarter_to_four() {
        assert_eq!([-1.0, 0.0, 1.0].map(factor), [0.25, 1.0, 4.0]);
        assert!((factor(0.3) * factor(-0.3) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn numbers_beyond_their_range_give_valid_factors() {
        let numbers = [9.0, f32::NEG_INFINITY, f32::NAN];
        assert_eq!(numbers.map(factor), [4.0, 0.25, 1.0]);
    }
}
