//! Conversion of a command to motion: limits, exact integration.

use geometry::math;
use geometry::pose::{Pose2, Twist2};
use nalgebra::Vector2;

use crate::spec::RobotModel;

/// The twist (m/s, rad/s) that a drive executes during a step of `dt` (s) for a finite `command`,
/// after `current`.
///
/// Speed and turning rate are first clamped to their limits. If a wheel would turn too fast, both
/// are scaled down together, which keeps the curvature. Then their changes are clamped to the
/// acceleration limits. If a wheel is still too fast, the turning rate is reduced: a wheel cannot
/// exceed its speed, so that limit precedes angular acceleration.
///
/// ```
/// use geometry::pose::Twist2;
/// use robot::drive::limit;
/// use robot::spec::Preset;
///
/// let model = Preset::Turtlebot3Burger.model();
/// let executed = limit(&model, Twist2::STOP, Twist2::new(100.0, 0.0), 0.05);
/// assert!(executed.v <= model.v_max);
/// ```
pub fn limit(model: &RobotModel, current: Twist2, command: Twist2, dt: f64) -> Twist2 {
    let half_track = 0.5 * model.wheel_separation;
    let mut v = command.v.clamp(-model.v_reverse_max, model.v_max);
    let mut omega = command.omega.clamp(-model.omega_max, model.omega_max);
    if let Some(max) = model.wheel_speed_max {
        let fastest = v.abs() + omega.abs() * half_track;
        if fastest > max {
            let scale = max / fastest;
            v *= scale;
            omega *= scale;
        }
    }
    if let Some(a) = model.acceleration {
        v = v.clamp(current.v - a * dt, current.v + a * dt);
    }
    if let Some(a) = model.angular_acceleration {
        omega = omega.clamp(current.omega - a * dt, current.omega + a * dt);
    }
    if let Some(max) = model.wheel_speed_max {
        let left = ((max - v.abs()) / half_track).max(0.0);
        omega = omega.clamp(-left, left);
    }
    Twist2::new(v, omega)
}

/// sin(x)/x, accurate to rounding for every x.
fn sinc(x: f64) -> f64 {
    if x.abs() < 0.1 {
        // The next term, x¹⁰/11!, is below 10⁻¹⁷.
        let s = x * x;
        1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0)))
    } else {
        math::sin(x) / x
    }
}

/// The displacement (m) of a robot with heading `theta` (rad) that keeps a twist for `dt` (s).
///
/// The end of an arc lies at the arc's length times sinc(φ/2) in the direction of its middle
/// heading, φ being the angle turned. This form needs no division by ω and no special case for
/// driving straight.
pub fn arc_displacement(theta: f64, twist: Twist2, dt: f64) -> Vector2<f64> {
    let half_turn = 0.5 * twist.omega * dt;
    let chord = twist.v * dt * sinc(half_turn);
    let (sin, cos) = math::sincos(theta + half_turn);
    Vector2::new(chord * cos, chord * sin)
}

/// The heading (rad) after turning by `turn`, wrapped.
pub fn turned(theta: f64, turn: f64) -> f64 {
    let sum = theta + turn;
    let pi = core::f64::consts::PI;
    if sum > -pi && sum <= pi {
        sum
    } else {
        math::wrap_angle(sum)
    }
}

/// The pose after keeping a twist for `dt` (s): exact integration of the unicycle.
pub fn integrate(pose: Pose2, twist: Twist2, dt: f64) -> Pose2 {
    let shift = arc_displacement(pose.theta, twist, dt);
    Pose2 {
        x: pose.x + shift.x,
        y: pose.y + shift.y,
        theta: turned(pose.theta, twist.omega * dt),
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::{FRAC_PI_2, PI};

    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_quarter_turn_ends_beside_and_ahead() {
        // Radius 2: from the origin heading +x to (2, 2) heading +y.
        let end = integrate(
            Pose2::default(),
            Twist2::new(FRAC_PI_2 * 2.0, FRAC_PI_2),
            1.0,
        );
        assert!((end.x - 2.0).abs() < 1e-12 && (end.y - 2.0).abs() < 1e-12);
        assert!((end.theta - FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn straight_is_the_limit_of_ever_wider_arcs() {
        let straight = integrate(Pose2::new(1.0, 2.0, 0.3), Twist2::new(1.0, 0.0), 2.0);
        for omega in [1e-300, 1e-12, 1e-8] {
            let arc = integrate(Pose2::new(1.0, 2.0, 0.3), Twist2::new(1.0, omega), 2.0);
            assert!((arc.position() - straight.position()).norm() < 3.0 * omega + 1e-15);
        }
    }

    #[test]
    fn wheels_share_their_speed() {
        let model = RobotModel::lego_nxt();
        let executed = limit(
            &model,
            Twist2::STOP,
            Twist2::new(1.0, model.omega_max),
            0.05,
        );
        let fastest = executed.v + executed.omega * 0.5 * model.wheel_separation;
        assert!((fastest - 0.15).abs() < 1e-12);
        assert!((executed.v - 0.075).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn two_halves_make_the_whole(
            x in -5.0..5.0f64, theta in -3.1..3.1f64, v in -100.0..100.0f64,
            omega in -50.0..50.0f64, dt in 0.0..1.0f64,
        ) {
            let (pose, twist) = (Pose2::new(x, 1.0, theta), Twist2::new(v, omega));
            let whole = integrate(pose, twist, dt);
            let halves = integrate(integrate(pose, twist, dt / 2.0), twist, dt / 2.0);
            prop_assert!((whole.position() - halves.position()).norm() < 1e-11);
            prop_assert!(math::angle_difference(whole.theta, halves.theta).abs() < 1e-12);
            prop_assert!(whole.theta > -PI && whole.theta <= PI);
        }

        #[test]
        fn no_limit_is_ever_exceeded(
            v in -9.0..9.0f64, omega in -9.0..9.0f64, v0 in -0.5..1.0f64, w0 in -2.0..2.0f64,
            dt in 0.0..0.5f64,
        ) {
            let model = RobotModel {
                radius: 0.1, wheel_separation: 0.2, v_max: 1.0, v_reverse_max: 0.5, omega_max: 4.0,
                acceleration: Some(2.0), angular_acceleration: Some(3.0),
                wheel_speed_max: Some(1.2),
            };
            let current = Twist2::new(v0, w0);
            let next = limit(&model, current, Twist2::new(v, omega), dt);
            prop_assert!((-0.5..=1.0).contains(&next.v) && next.omega.abs() <= 4.0);
            prop_assert!(next.v.abs() + next.omega.abs() * 0.1 <= 1.2 + 1e-12);
            prop_assert!((next.v - v0).abs() <= 2.0 * dt + 1e-12);
        }
    }
}
