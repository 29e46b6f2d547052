//! Turning rates from which a robot can stop turning in time.

use geometry::math;
use geometry::pose::{Pose2, Twist2};
use nalgebra::Point2;

use control::go_to::bearing;

/// Limits the command of a robot with this angular acceleration (rad/s²) on its way to a point. The
/// turning rate allows it to stop in the direction of the point, and the forward speed keeps the
/// point on that arc.
///
/// Without this limit, a robot whose turning rate lags oscillates about its path.
pub fn ease(
    command: Twist2,
    pose: &Pose2,
    towards: Point2<f64>,
    angular_acceleration: f64,
    dt: f64,
) -> Twist2 {
    let alpha = bearing(pose, towards);
    // In ticks: ω²/(2b) + ω·dt/2 ≤ |α|; solved so that small angles do not cancel out.
    let tick = 0.5 * angular_acceleration * dt;
    let reach = 2.0 * angular_acceleration * alpha.abs();
    let most = reach / ((tick * tick + reach).sqrt() + tick);
    if command.omega.abs() <= most {
        return command;
    }
    let distance = (towards - pose.position()).norm();
    let bend = 2.0 * math::sin(alpha).abs() / distance;
    let v = if bend * command.v > most {
        most / bend
    } else {
        command.v
    };
    Twist2::new(v, most.copysign(command.omega))
}
