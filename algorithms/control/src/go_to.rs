//! Driving to a point: turn towards it, then drive the arc that leads to it.
//!
//! With the point at distance ℓ under the bearing α, the circle that leaves the robot along its
//! heading and passes through the point has the curvature 2 sin α / ℓ (pure pursuit, Coulter 1992). A
//! robot that turns faster than that circle requires is aligned sooner and drives the rest straight.
//! The speed is limited so that the point never lies inside the tightest circle; otherwise the robot
//! could circle a near point forever.

use core::f64::consts::PI;

use geometry::math;
use geometry::pose::{Pose2, Twist2};
use nalgebra::{Point2, Vector2};
use parameters::{Parameters, above, between};

use planner_view::limits::Limits;

/// Distance (m) below which a point coincides with the robot's position.
const SAME_PLACE: f64 = 1e-9;

parameters::table! {
    /// Parameters of [`go_to`].
    #[derive(Copy)]
    pub struct GoToParams {
        /// Bearing above which the robot turns on the spot. The larger, the faster a lap and the farther
        /// the path bulges out behind a corner (by the speed over the turning rate at most).
        pub turn_on_spot: f64 [above(0).at_most(PI).unit("rad")] = 0.8,
        /// Turning rate per bearing; a tick turns by at most the bearing.
        pub turn_gain: f64 [above(0).unit("1/s")] = 10.0,
        /// Maximum speed, as a fraction of the maximum forward speed.
        pub speed_fraction: f64 [above(0).at_most(1)] = 1.0,
        /// Distance at which the robot has reached the point.
        pub arrived: f64 [above(0).unit("m")] = 0.05,
        /// Deceleration before the point; absent: the robot passes it at full speed.
        pub deceleration: Option<f64> [above(0).unit("m/s²")],
        /// With a deceleration: change of direction up to which the robot still passes the point at speed,
        /// if the next point is known.
        pub pass_angle: f64 [between(0, PI).unit("rad")] = 0.5,
    }
}

impl Parameters for GoToParams {}

/// Bearing of a point from a pose (rad), in (−π, π]; 0 if the point coincides with the position.
pub fn bearing(pose: &Pose2, point: Point2<f64>) -> f64 {
    let forward = pose.forward();
    let offset = point - pose.position();
    math::atan2(forward.perp(&offset), forward.dot(&offset))
}

/// The command that leads from a pose to `target` (m) in ticks of `dt` (s).
///
/// `onward` is the next target, if it is known: the robot does not slow down for a target that lies on
/// the path to it. The command is finite and within the limits. It is a stop at the target, and for a
/// pose, target or tick that is not finite.
pub fn go_to(
    pose: &Pose2,
    target: Point2<f64>,
    onward: Option<Point2<f64>>,
    limits: &Limits,
    params: &GoToParams,
    dt: f64,
) -> Twist2 {
    let offset = target - pose.position();
    let distance = offset.norm();
    // This form stops for NaN as well.
    let usable = distance >= SAME_PLACE && distance.is_finite() && dt > 0.0;
    if !usable {
        return Twist2::STOP;
    }
    let alpha = bearing(pose, target);
    let wanted = params.turn_gain.min(1.0 / dt) * alpha;
    if alpha.abs() > params.turn_on_spot {
        return limits.clip(Twist2::new(0.0, wanted));
    }
    let bend = 2.0 * math::sin(alpha).abs() / distance;
    let mut v = limits.v_max() * params.speed_fraction;
    if bend * v > limits.omega_max() {
        v = limits.omega_max() / bend;
    }
    if let Some(deceleration) = params.deceleration
        && !passes(offset, onward.map(|onward| onward - target), params)
    {
        // Do not stop short of the tolerance.
        let left = (distance - 0.5 * params.arrived).max(0.0);
        v = v.min((2.0 * deceleration * left).sqrt()).min(distance / dt);
    }
    let omega = wanted.abs().max(bend * v);
    limits.clip(Twist2::new(v, omega.copysign(alpha)))
}

/// Returns `true` if a robot that arrives along `before` can continue along `after` without slowing
/// down.
fn passes(before: Vector2<f64>, after: Option<Vector2<f64>>, params: &GoToParams) -> bool {
    after.is_some_and(|after| {
        let turn = math::atan2(before.perp(&after), before.dot(&after));
        after.norm() > SAME_PLACE && turn.abs() <= params.pass_angle
    })
}

/// The pose after a constant twist for `dt` (s), without limits or slip.
pub fn coast(pose: &Pose2, twist: Twist2, dt: f64) -> Pose2 {
    let half = 0.5 * twist.omega * dt;
    // The chord of the arc lies in the direction of its middle.
    let sinc = if half.abs() < 1e-6 {
        1.0 - half * half / 6.0
    } else {
        math::sin(half) / half
    };
    let (sin, cos) = math::sincos(pose.theta + half);
    let chord = Vector2::new(cos, sin) * (twist.v * dt * sinc);
    Pose2::new(
        pose.x + chord.x,
        pose.y + chord.y,
        pose.theta + twist.omega * dt,
    )
}

/// Distance (m) from a point to the segment from `a` to `b`.
pub fn distance_to_segment(p: Point2<f64>, a: Point2<f64>, b: Point2<f64>) -> f64 {
    let line = b - a;
    let length_squared = line.norm_squared();
    let part = if length_squared > 0.0 {
        ((p - a).dot(&line) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (p - (a + line * part)).norm()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use parameters::check;

    use super::*;

    const DT: f64 = 0.05;

    fn limits() -> Limits {
        Limits::new(1.0, 0.0, 3.0).unwrap()
    }

    fn drive(mut pose: Pose2, target: Point2<f64>, params: &GoToParams) -> Option<(f64, f64)> {
        for tick in 0..2000 {
            let command = go_to(&pose, target, None, &limits(), params, DT);
            assert!(limits().allow(command));
            let next = coast(&pose, command, DT);
            if distance_to_segment(target, pose.position(), next.position()) <= params.arrived {
                return Some((f64::from(tick + 1) * DT, command.v));
            }
            pose = next;
        }
        None
    }

    #[test]
    fn a_point_behind_costs_half_a_turn_and_the_distance() {
        let (time, v) = drive(
            Pose2::default(),
            Point2::new(-4.0, 0.0),
            &GoToParams::default(),
        )
        .unwrap();
        assert!((4.0..PI / 3.0 + 4.3).contains(&time), "{time}");
        assert_eq!(
            v, 1.0,
            "without a deceleration the point is passed at speed"
        );
    }

    #[test]
    fn the_robot_slows_down_only_for_a_point_it_turns_at() {
        let params = GoToParams {
            deceleration: Some(0.5),
            ..GoToParams::default()
        };
        let go = |onward| {
            go_to(
                &Pose2::default(),
                Point2::new(0.2, 0.0),
                onward,
                &limits(),
                &params,
                DT,
            )
            .v
        };
        assert_eq!(go(Some(Point2::new(1.0, 0.2))), 1.0);
        assert!(go(Some(Point2::new(0.2, 1.0))) < 0.5);
        assert!(go(None) < 0.5);
        assert!(drive(Pose2::default(), Point2::new(3.0, 1.0), &params).is_some());
    }

    #[test]
    fn input_that_is_not_finite_stops_the_robot() {
        let params = GoToParams::default();
        let nan = Point2::new(f64::NAN, 0.0);
        let there = Point2::new(1.0, 0.0);
        let (pose, lost) = (
            Pose2::default(),
            Pose2 {
                x: f64::NAN,
                ..Pose2::default()
            },
        );
        assert_eq!(
            go_to(&pose, nan, None, &limits(), &params, DT),
            Twist2::STOP
        );
        assert_eq!(
            go_to(&lost, there, None, &limits(), &params, DT),
            Twist2::STOP
        );
        assert_eq!(
            go_to(&pose, there, None, &limits(), &params, 0.0),
            Twist2::STOP
        );
        assert_eq!(
            go_to(&pose, Point2::origin(), None, &limits(), &params, DT),
            Twist2::STOP
        );
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        let field = |params: GoToParams| check(&params).unwrap_err().field;
        let good = GoToParams::default();
        assert!(check(&good).is_ok());
        assert_eq!(
            field(GoToParams {
                turn_on_spot: 4.0,
                ..good
            }),
            "turn_on_spot"
        );
        assert_eq!(
            field(GoToParams {
                speed_fraction: 0.0,
                ..good
            }),
            "speed_fraction"
        );
        assert_eq!(
            field(GoToParams {
                deceleration: Some(0.0),
                ..good
            }),
            "deceleration"
        );
        assert_eq!(
            field(GoToParams {
                pass_angle: -0.1,
                ..good
            }),
            "pass_angle"
        );
    }

    proptest! {
        #[test]
        fn every_point_is_reached_soon_and_none_is_circled(
            x in -3.0..3.0f64, y in -3.0..3.0f64, theta in -3.1..3.1f64,
            spot in 0.2..3.1f64, slow in any::<bool>(),
        ) {
            let params = GoToParams {
                turn_on_spot: spot,
                deceleration: slow.then_some(1.0),
                ..GoToParams::default()
            };
            let target = Point2::new(x, y);
            let straight = target.coords.norm() + PI / 3.0;
            let (time, _) = drive(Pose2::new(0.0, 0.0, theta), target, &params).unwrap();
            prop_assert!(time < 1.4 * straight + 1.5, "{time} {straight}");
        }
    }
}
