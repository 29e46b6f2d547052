//! Actions: commands as numbers in −1..1.

use core::str::FromStr;

use geometry::pose::Twist2;
use robot::spec::RobotModel;

use crate::error::LayoutError;

/// Numbers of an action.
pub const ACTION_LENGTH: usize = 2;

/// Meaning of an action.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ActionKind {
    /// Forward speed and turning rate: [`command`].
    #[default]
    Twist,
    /// Parameters of the potential-field evader: [`FieldEvader`](crate::field_evader::FieldEvader).
    Tune,
    /// Correction: a sum with the action of the potential-field evader.
    Residual,
}

impl FromStr for ActionKind {
    type Err = LayoutError;

    fn from_str(text: &str) -> Result<Self, LayoutError> {
        match text {
            "twist" => Ok(Self::Twist),
            "tune" => Ok(Self::Tune),
            "residual" => Ok(Self::Residual),
            _ => Err(LayoutError::Action {
                given: text.to_owned(),
            }),
        }
    }
}

/// Returns the command of an action.
///
/// The first number is the speed: 1 is the maximum forward speed of the robot, −1 its maximum backward speed. The second
/// one is the turning rate: ±1 is its maximum, counter-clockwise positive. Numbers beyond ±1 are clamped; an action
/// that is not finite is a stop.
///
/// ```
/// use observation::action::command;
/// use robot::spec::Preset;
///
/// let model = Preset::Turtlebot3Burger.model();
/// let twist = command([0.5, -1.0], &model);
/// assert_eq!((twist.v, twist.omega), (0.11, -2.84));
/// ```
pub fn command(action: [f32; ACTION_LENGTH], model: &RobotModel) -> Twist2 {
    let [speed, turn] = action.map(f64::from);
    if !(speed.is_finite() && turn.is_finite()) {
        return Twist2::STOP;
    }
    let (speed, turn) = (speed.clamp(-1.0, 1.0), turn.clamp(-1.0, 1.0));
    let limit = if speed < 0.0 {
        model.v_reverse_max
    } else {
        model.v_max
    };
    Twist2::new(speed * limit, turn * model.omega_max)
}

/// Returns the action of a command, clamped to −1..1; the inverse of [`command`].
pub fn action(command: Twist2, model: &RobotModel) -> [f32; ACTION_LENGTH] {
    let limit = if command.v < 0.0 {
        model.v_reverse_max
    } else {
        model.v_max
    };
    let share = |value: f64, limit: f64| {
        if value == 0.0 || limit <= 0.0 {
            0.0
        } else {
            (value / limit).clamp(-1.0, 1.0) as f32
        }
    };
    [
        share(command.v, limit),
        share(command.omega, model.omega_max),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use robot::spec::Preset;

    #[test]
    fn backward_speeds_have_their_own_limit() {
        let model = RobotModel {
            v_reverse_max: 0.05,
            ..Preset::Turtlebot3Burger.model()
        };
        assert_eq!(command([-1.0, 0.0], &model), Twist2::new(-0.05, 0.0));
        assert_eq!(command([9.0, 9.0], &model), Twist2::new(0.22, 2.84));
    }

    #[test]
    fn actions_and_commands_are_inverse() {
        let model = RobotModel {
            v_reverse_max: 0.05,
            ..Preset::Turtlebot3Burger.model()
        };
        for given in [[0.5, -0.25], [-0.5, 1.0], [0.0, 0.0]] {
            assert_eq!(action(command(given, &model), &model), given);
        }
        let forward_only = RobotModel {
            v_reverse_max: 0.0,
            ..model
        };
        assert_eq!(action(Twist2::new(-1.0, 0.0), &forward_only), [0.0, 0.0]);
    }

    #[test]
    fn an_action_that_is_not_finite_is_a_stop() {
        let model = Preset::Turtlebot3Burger.model();
        for bad in [f32::NAN, f32::INFINITY] {
            assert_eq!(command([bad, 0.5], &model), Twist2::STOP);
            assert_eq!(command([0.5, bad], &model), Twist2::STOP);
        }
    }
}
