//! No faster than the robot can still stop before what it sees.

use nalgebra::Vector2;
use sim_backend::pose::{Pose2, Twist2};

use super::DriverParams;
use crate::go_to::coast;

/// Parts of the commanded speed tried, one after the other; then the robot turns on the spot.
const SPEEDS: [f64; 9] = [1.0, 0.75, 0.55, 0.4, 0.28, 0.2, 0.14, 0.09, 0.05];
/// Places of the way ahead that are looked at.
const PLACES: u32 = 6;
/// How much nearer than now the robot may come to what is too near already [fraction].
const CREEP: f64 = 0.003;

/// The command, slowed down so that the robot stays clear of the echoes (relative to its centre, in
/// world axes [m]) until it can stand. Its turning rate is kept: it turns on the spot if nothing
/// faster is clear.
pub(super) fn slow_down(
    command: Twist2,
    pose: &Pose2,
    echoes: &[Vector2<f64>],
    radius: f64,
    params: &DriverParams,
) -> Twist2 {
    if command.v <= 0.0 {
        return command;
    }
    // Half of the margin: the other half is for straying from the way that was found clear.
    let keep = radius + 0.5 * params.tangent_bug.margin;
    let clear = |twist: Twist2| {
        let braking = params.braking.map_or(0.0, |a| twist.v / (2.0 * a));
        let ahead = params.reaction_s + braking;
        let start = Pose2::new(0.0, 0.0, pose.theta);
        (1..=PLACES).all(|place| {
            let time = ahead * f64::from(place) / f64::from(PLACES);
            let at = coast(&start, twist, time).position().coords;
            echoes.iter().all(|echo| {
                let now = echo.norm();
                let least = if now < keep {
                    (now * (1.0 - CREEP)).max(radius).min(now)
                } else {
                    keep
                };
                (at - echo).norm_squared() >= least * least
            })
        })
    };
    SPEEDS
        .iter()
        .map(|part| Twist2::new(command.v * part, command.omega))
        .find(|&twist| clear(twist))
        .unwrap_or(Twist2::new(0.0, command.omega))
}
