//! Feedback linearisation: steering a point ahead of the axle as if it could move any way.
//!
//! A differential-drive robot at heading θ cannot move sideways, but the point at distance ε ahead
//! of its axle can: with forward speed u and turning rate ω it moves with
//! u·(cos θ, sin θ) + ε·ω·(−sin θ, cos θ). Solved for (u, ω) this gives the control that moves the
//! point with a wanted velocity (chasing-game paper, §I-A):
//!
//! ```text
//! u = vx cos θ + vy sin θ        ω = (−vx sin θ + vy cos θ) / ε
//! ```

use core::f64::consts::{PI, TAU};

use nalgebra::{Point2, Vector2};
use serde::{Deserialize, Serialize};
use sim_backend::math;
use sim_backend::pose::{Pose2, Twist2};

use crate::limits::Limits;
use crate::params::{ParamsError, fraction, not_negative, positive};

/// Which formula turns a wanted velocity into a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ControlLaw {
    /// The inverse of the kinematics, as in the module's description.
    #[default]
    Exact,
    /// The formula that the chasing-game paper's experiments ran with. It adds a turning term
    /// proportional to the angle between heading and wanted velocity, and divides only the
    /// cos θ part of ω by ε, so that a robot driving along ±y turns 1/ε times more weakly than
    /// one driving along ±x.
    Paper,
}

/// What happens to a command beyond the robot's limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Clipping {
    /// Backward speed is clipped; after that forward speed and turning rate shrink by one common
    /// factor, so that the control point keeps the wanted *direction* and loses only speed.
    #[default]
    Scale,
    /// Each component is clipped on its own (the paper's): full forward speed while the turning
    /// rate saturates, so that the robot leaves the wanted direction in tight turns.
    Clip,
}

/// Parameters of the feedback linearisation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FeedbackParams {
    /// Which formula is used.
    pub law: ControlLaw,
    /// What happens beyond the limits.
    pub clipping: Clipping,
    /// Distance ε of the control point ahead of the axle [m], > 0.
    pub epsilon: f64,
    /// Distance ahead of the axle at which the potential field is evaluated [m], ≥ 0. The theory
    /// wants ε itself; the paper's experiments used a third of it.
    pub field_point: f64,
    /// A wanted speed below this [m/s] means: stand still.
    pub dead_band: f64,
    /// Backward speed allowed, as a fraction of the highest forward speed, in [0, 1].
    pub reverse_fraction: f64,
    /// Turning rate allowed [rad/s] when lower than the robot's own limit; absent: the robot's.
    pub omega_cap: Option<f64>,
    /// With the wanted velocity behind the robot, the exact law turns ever more slowly the more
    /// directly behind it lies. When set, the robot then turns as fast as for a velocity straight
    /// to its side, until the velocity is no longer behind it.
    pub turn_around: bool,
}

impl Default for FeedbackParams {
    fn default() -> Self {
        Self {
            law: ControlLaw::Exact,
            clipping: Clipping::Scale,
            epsilon: 0.15,
            field_point: 0.15,
            dead_band: 0.01,
            reverse_fraction: 0.1,
            omega_cap: None,
            turn_around: true,
        }
    }
}

impl FeedbackParams {
    /// The values of the chasing-game paper's experiments.
    pub fn paper() -> Self {
        Self {
            law: ControlLaw::Paper,
            clipping: Clipping::Clip,
            epsilon: 0.15,
            field_point: 0.05,
            dead_band: 0.01,
            reverse_fraction: 0.1,
            omega_cap: Some(0.5),
            turn_around: false,
        }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        positive("epsilon", self.epsilon)?;
        not_negative("field_point", self.field_point)?;
        not_negative("dead_band", self.dead_band)?;
        fraction("reverse_fraction", self.reverse_fraction)?;
        self.omega_cap
            .map_or(Ok(()), |cap| positive("omega_cap", cap))
    }

    /// The point [m] at which a robot at `pose` evaluates its potential field.
    pub fn field_point_of(&self, pose: &Pose2) -> Point2<f64> {
        pose.position() + pose.forward() * self.field_point
    }
}

/// The command that moves a robot's control point with a wanted velocity.
///
/// * `wanted` — velocity of the control point in the world frame [m/s]; may be far beyond what the
///   robot can do, only its direction matters then.
/// * `theta` — the robot's heading [rad].
/// * `limits` — what the robot can do; narrowed further by `reverse_fraction` and `omega_cap`.
///
/// Returns a command that is finite and within the limits whatever the input; NaN or infinite
/// input stops the robot.
pub fn command(
    wanted: Vector2<f64>,
    theta: f64,
    limits: &Limits,
    params: &FeedbackParams,
) -> Twist2 {
    let limits = limits.restricted(params.reverse_fraction, params.omega_cap);
    let speed = wanted.norm();
    if !speed.is_finite() || !theta.is_finite() || speed < params.dead_band {
        return Twist2::STOP;
    }
    let raw = match params.law {
        ControlLaw::Exact => exact(wanted, theta, params.epsilon),
        ControlLaw::Paper => as_in_the_papers_experiments(wanted, theta, params.epsilon),
    };
    let raw = if params.turn_around && raw.v < 0.0 {
        let side = if raw.omega < 0.0 { -1.0 } else { 1.0 };
        Twist2::new(raw.v, side * speed / params.epsilon)
    } else {
        raw
    };
    match params.clipping {
        Clipping::Clip => limits.clip(raw),
        Clipping::Scale => scale(raw, &limits),
    }
}

fn exact(wanted: Vector2<f64>, theta: f64, epsilon: f64) -> Twist2 {
    let (sin, cos) = math::sincos(theta);
    Twist2::new(
        wanted.x * cos + wanted.y * sin,
        (-wanted.x * sin + wanted.y * cos) / epsilon,
    )
}

fn as_in_the_papers_experiments(wanted: Vector2<f64>, theta: f64, epsilon: f64) -> Twist2 {
    let (sin, cos) = math::sincos(theta);
    let turn = math::atan2(wanted.y, wanted.x) - theta;
    // Wrapped into [−π, π): a target exactly behind turns the robot clockwise.
    let turn = turn - TAU * ((turn + PI) / TAU).floor();
    let dx = wanted.x - epsilon * turn * sin;
    let dy = wanted.y + epsilon * turn * cos;
    Twist2::new(dx * cos + dy * sin, -dx * sin + dy * cos / epsilon)
}

/// Backward speed clipped, then both components shrunk by one factor.
fn scale(raw: Twist2, limits: &Limits) -> Twist2 {
    let v = raw.v.max(-limits.reverse());
    let by_speed = if v > limits.v_max() {
        limits.v_max() / v
    } else {
        1.0
    };
    let by_turn = if raw.omega.abs() > limits.omega_max() {
        limits.omega_max() / raw.omega.abs()
    } else {
        1.0
    };
    let factor = by_speed.min(by_turn);
    // The last clip takes off the rounding error of the product.
    limits.clip(Twist2::new(v * factor, raw.omega * factor))
}

#[cfg(test)]
mod tests {
    use core::f64::consts::FRAC_PI_2;

    use proptest::prelude::*;

    use super::*;

    fn limits() -> Limits {
        Limits::new(0.3, 0.3, 2.84).unwrap()
    }

    fn assert_command(got: Twist2, v: f64, omega: f64) {
        assert!(
            (got.v - v).abs() < 6e-5 && (got.omega - omega).abs() < 6e-5,
            "{got:?}"
        );
    }

    #[test]
    fn the_papers_law_gives_the_papers_commands() {
        let params = FeedbackParams::paper();
        for (theta, vx, vy, v, omega) in [
            (0.0, 1.0, 0.0, 0.3, 0.0),
            (0.0, 0.0, 1.0, 0.0, 0.5),
            (FRAC_PI_2, 1.0, 0.0, 0.0, -0.5),
            (FRAC_PI_2, 0.1, 0.0, 0.0, -0.3356),
            (PI, 1.0, 0.2, -0.03, -0.5),
            (0.0, -1.0, 0.0, -0.03, -0.5),
            (0.0, 0.02, 0.02, 0.02, 0.5),
        ] {
            assert_command(
                command(Vector2::new(vx, vy), theta, &limits(), &params),
                v,
                omega,
            );
        }
    }

    #[test]
    fn the_exact_law_shares_the_commands_in_which_the_papers_is_right() {
        let params = FeedbackParams {
            law: ControlLaw::Exact,
            ..FeedbackParams::paper()
        };
        for (theta, vx, vy, v, omega) in [
            (0.0, 1.0, 0.0, 0.3, 0.0),
            (0.0, 0.0, 1.0, 0.0, 0.5),
            (FRAC_PI_2, 1.0, 0.0, 0.0, -0.5),
            (PI, 1.0, 0.2, -0.03, -0.5),
        ] {
            assert_command(
                command(Vector2::new(vx, vy), theta, &limits(), &params),
                v,
                omega,
            );
        }
        // Where the paper's turning term distorts it, the inverse kinematics give another answer.
        let diagonal = command(Vector2::new(0.02, 0.02), 0.0, &limits(), &params);
        assert_command(diagonal, 0.02, 0.02 / 0.15);
    }

    #[test]
    fn the_papers_gain_depends_on_the_compass_and_ours_does_not() {
        // The same sideways velocity seen from a robot heading along +x and along +y.
        let params = FeedbackParams {
            omega_cap: None,
            ..FeedbackParams::paper()
        };
        let east = command(Vector2::new(0.0, 0.1), 0.0, &limits(), &params).omega;
        let north = command(Vector2::new(-0.1, 0.0), FRAC_PI_2, &limits(), &params).omega;
        assert!(east > 5.0 * north, "paper: {east} against {north}");
        let ours = FeedbackParams::default();
        let east = command(Vector2::new(0.0, 0.1), 0.0, &limits(), &ours).omega;
        let north = command(Vector2::new(-0.1, 0.0), FRAC_PI_2, &limits(), &ours).omega;
        assert!(
            (east - north).abs() < 1e-12,
            "exact: {east} against {north}"
        );
        assert!((east - 0.1 / 0.15).abs() < 1e-12);
    }

    #[test]
    fn an_unsaturated_exact_command_moves_the_control_point_as_wanted() {
        let params = FeedbackParams::default();
        for theta in [-2.0, -0.4, 0.0, 0.9, 3.0] {
            let pose = Pose2::new(0.0, 0.0, theta);
            let side = Vector2::new(-pose.forward().y, pose.forward().x);
            let wanted = pose.forward() * 0.2 + side * 0.1;
            let got = command(wanted, theta, &limits(), &params);
            let moved = pose.forward() * got.v + side * (params.epsilon * got.omega);
            assert!((moved - wanted).norm() < 1e-12);
        }
    }

    #[test]
    fn scaling_keeps_the_direction_that_clipping_loses() {
        let wanted = Vector2::new(2.0, 1.0);
        let direction = |clipping| {
            let params = FeedbackParams {
                clipping,
                ..FeedbackParams::default()
            };
            let got = command(wanted, 0.0, &limits(), &params);
            math::atan2(params.epsilon * got.omega, got.v)
        };
        let wanted_direction = math::atan2(1.0, 2.0);
        assert!((direction(Clipping::Scale) - wanted_direction).abs() < 1e-12);
        assert!((direction(Clipping::Clip) - wanted_direction).abs() > 0.1);
    }

    #[test]
    fn a_goal_behind_turns_the_robot_round_at_once() {
        let got = command(
            Vector2::new(-1.0, 0.0),
            0.0,
            &limits(),
            &FeedbackParams::default(),
        );
        assert!(got.omega.abs() > 2.8, "{got:?}");
        let lazy = FeedbackParams {
            turn_around: false,
            ..FeedbackParams::default()
        };
        let got = command(Vector2::new(-1.0, 0.0), 0.0, &limits(), &lazy);
        assert_eq!(got.omega, 0.0);
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        let bad = FeedbackParams {
            epsilon: 0.0,
            ..FeedbackParams::default()
        };
        assert_eq!(bad.validate().unwrap_err().field, "epsilon");
        let bad = FeedbackParams {
            omega_cap: Some(-1.0),
            ..FeedbackParams::default()
        };
        assert_eq!(bad.validate().unwrap_err().field, "omega_cap");
        FeedbackParams::default().validate().unwrap();
        FeedbackParams::paper().validate().unwrap();
    }

    proptest! {
        #[test]
        fn commands_are_finite_and_within_limits_for_any_input(
            x in prop::num::f64::ANY,
            y in prop::num::f64::ANY,
            theta in prop::num::f64::ANY,
            paper_law in any::<bool>(),
            clip in any::<bool>(),
            turn_around in any::<bool>(),
        ) {
            let params = FeedbackParams {
                law: if paper_law { ControlLaw::Paper } else { ControlLaw::Exact },
                clipping: if clip { Clipping::Clip } else { Clipping::Scale },
                turn_around,
                ..FeedbackParams::default()
            };
            let got = command(Vector2::new(x, y), theta, &limits(), &params);
            prop_assert!(limits().allow(got), "{:?}", got);
        }
    }
}
