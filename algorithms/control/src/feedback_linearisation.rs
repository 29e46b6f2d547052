//! Feedback linearisation: control of a point ahead of the axle, which can move in any direction.
//!
//! A differential-drive robot at heading θ cannot move sideways, but the point at distance ε ahead
//! of its axle can. With forward speed u and turning rate ω it moves with u·(cos θ, sin θ) +
//! ε·ω·(−sin θ, cos θ). Solved for (u, ω) this gives the control that moves the point with a
//! desired velocity (chasing-game paper, §I-A):
//!
//! ```text
//! u = vx cos θ + vy sin θ        ω = (−vx sin θ + vy cos θ) / ε
//! ```

use core::f64::consts::{PI, TAU};

use geometry::math;
use geometry::pose::{Pose2, Twist2};
use nalgebra::{Point2, Vector2};
use parameters::{Fidelity, Parameters, above};

use planner_view::limits::Limits;

/// Distance ε of the control point ahead of the axle (m).
pub const EPSILON: f64 = 0.15;

/// Distance ahead of the axle at which the published program evaluates the potential field (m); the theory
/// requires ε itself.
const PUBLISHED_FIELD_POINT: f64 = 0.05;

/// Distance of the axle from a place at which the place attracts the axle itself, relative to the
/// distance of the field point ahead of it: a field point that rests in the place is within.
const ARRIVING: f64 = 1.1;

/// Desired speed (m/s) below which the robot stands still.
const DEAD_BAND: f64 = 0.01;

/// Maximum backward speed, as a fraction of the maximum forward speed.
const REVERSE_FRACTION: f64 = 0.1;

parameters::table! {
    /// Parameters of the feedback linearisation.
    #[derive(Copy)]
    pub struct FeedbackParams {
        /// Variant of the law. [`Fidelity::Ours`]: the inverse of the kinematics, with the field taken at
        /// the control point. A command beyond the limits loses speed and keeps the desired direction, and
        /// a robot turns at its full rate towards a target behind it.
        ///
        /// [`Fidelity::Published`]: a turning term proportional to the angle between heading and
        /// desired velocity is added. Only the cos θ part of ω is divided by ε, so that a robot driving
        /// along ±y turns 1/ε times more weakly than one driving along ±x. The field is taken at a
        /// third of ε. Forward speed and turning rate are clipped separately, so that the robot leaves
        /// the desired direction in tight turns.
        pub fidelity: Fidelity,
        /// Maximum turning rate when lower than the robot's own limit; absent: the robot's.
        pub omega_cap: Option<f64> [above(0).unit("rad/s")],
    }
}

impl Parameters for FeedbackParams {}

impl FeedbackParams {
    /// The values of the chasing-game paper's experiments.
    pub fn paper() -> Self {
        Self {
            fidelity: Fidelity::Published,
            omega_cap: Some(0.5),
        }
    }

    /// The point (m) at which a robot at `pose` evaluates its potential field.
    pub fn field_point_of(&self, pose: &Pose2) -> Point2<f64> {
        pose.position() + pose.forward() * self.ahead()
    }

    /// The point (m) of a robot at `pose` that a place attracts: the field point, or the axle once it
    /// is hardly farther from the place than the field point is from the axle. Otherwise the robot
    /// would come to rest with the field point, and not its axle, in the place.
    pub fn attracted_point_of(&self, pose: &Pose2, place: Point2<f64>) -> Point2<f64> {
        if (place - pose.position()).norm() < ARRIVING * self.ahead() {
            pose.position()
        } else {
            self.field_point_of(pose)
        }
    }

    /// Distance of the field point ahead of the axle (m).
    fn ahead(&self) -> f64 {
        match self.fidelity {
            Fidelity::Ours => EPSILON,
            Fidelity::Published => PUBLISHED_FIELD_POINT,
        }
    }
}

/// The command that moves a robot's control point with a desired velocity.
///
/// * `wanted` — velocity of the control point in the world frame (m/s); only its direction matters if it
///   exceeds the robot's limits.
/// * `theta` — the robot's heading (rad).
/// * `limits` — the robot's limits; narrowed further by `omega_cap`, and to a tenth of the forward speed
///   backwards.
///
/// Returns a command that is finite and within the limits whatever the input; NaN or infinite
/// input stops the robot.
pub fn command(
    wanted: Vector2<f64>,
    theta: f64,
    limits: &Limits,
    params: &FeedbackParams,
) -> Twist2 {
    let limits = limits.restricted(REVERSE_FRACTION, params.omega_cap);
    let speed = wanted.norm();
    if !speed.is_finite() || !theta.is_finite() || speed < DEAD_BAND {
        return Twist2::STOP;
    }
    match params.fidelity {
        Fidelity::Ours => {
            let mut raw = exact(wanted, theta);
            if raw.v < 0.0 {
                // The exact law turns ever more slowly the more directly behind the robot the velocity lies.
                // Turn as fast as for a velocity straight to its side.
                let side = if raw.omega < 0.0 { -1.0 } else { 1.0 };
                raw.omega = side * speed / EPSILON;
            }
            scale(raw, &limits)
        }
        Fidelity::Published => limits.clip(as_published(wanted, theta)),
    }
}

fn exact(wanted: Vector2<f64>, theta: f64) -> Twist2 {
    let (sin, cos) = math::sincos(theta);
    Twist2::new(
        wanted.x * cos + wanted.y * sin,
        (-wanted.x * sin + wanted.y * cos) / EPSILON,
    )
}

fn as_published(wanted: Vector2<f64>, theta: f64) -> Twist2 {
    let (sin, cos) = math::sincos(theta);
    let turn = math::atan2(wanted.y, wanted.x) - theta;
    // Wrapped into [−π, π): a target exactly behind turns the robot clockwise.
    let turn = turn - TAU * ((turn + PI) / TAU).floor();
    let dx = wanted.x - EPSILON * turn * sin;
    let dy = wanted.y + EPSILON * turn * cos;
    Twist2::new(dx * cos + dy * sin, -dx * sin + dy * cos / EPSILON)
}

/// Clips the backward speed, then scales both components by one factor.
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
    // The last clip removes the rounding error of the product.
    limits.clip(Twist2::new(v * factor, raw.omega * factor))
}

#[cfg(test)]
mod tests {
    use core::f64::consts::FRAC_PI_2;

    use proptest::prelude::*;

    use parameters::check;

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
            fidelity: Fidelity::Ours,
            ..FeedbackParams::paper()
        };
        for (theta, vx, vy, v, omega) in [
            (0.0, 1.0, 0.0, 0.3, 0.0),
            (0.0, 0.0, 1.0, 0.0, 0.5),
            (FRAC_PI_2, 1.0, 0.0, 0.0, -0.5),
        ] {
            assert_command(
                command(Vector2::new(vx, vy), theta, &limits(), &params),
                v,
                omega,
            );
        }
        // Where the paper's turning term distorts the command, the inverse kinematics give another result.
        let diagonal = command(Vector2::new(0.02, 0.02), 0.0, &limits(), &params);
        assert_command(diagonal, 0.02, 0.02 / 0.15);
    }

    #[test]
    fn the_papers_gain_depends_on_the_heading_and_ours_does_not() {
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
            let moved = pose.forward() * got.v + side * (EPSILON * got.omega);
            assert!((moved - wanted).norm() < 1e-12);
        }
    }

    #[test]
    fn scaling_keeps_the_direction_that_clipping_loses() {
        let raw = exact(Vector2::new(2.0, 1.0), 0.0);
        let direction = |got: Twist2| math::atan2(EPSILON * got.omega, got.v);
        let wanted = math::atan2(1.0, 2.0);
        assert!((direction(scale(raw, &limits())) - wanted).abs() < 1e-12);
        assert!((direction(limits().clip(raw)) - wanted).abs() > 0.1);
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
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        let bad = FeedbackParams {
            omega_cap: Some(-1.0),
            ..FeedbackParams::default()
        };
        assert_eq!(check(&bad).unwrap_err().field, "omega_cap");
        check(&FeedbackParams::default()).unwrap();
        check(&FeedbackParams::paper()).unwrap();
    }

    proptest! {
        #[test]
        fn commands_are_finite_and_within_limits_for_any_input(
            x in prop::num::f64::ANY,
            y in prop::num::f64::ANY,
            theta in prop::num::f64::ANY,
            published in any::<bool>(),
        ) {
            let params = FeedbackParams {
                fidelity: if published { Fidelity::Published } else { Fidelity::Ours },
                ..FeedbackParams::default()
            };
            let got = command(Vector2::new(x, y), theta, &limits(), &params);
            prop_assert!(limits().allow(got), "{:?}", got);
        }
    }
}
