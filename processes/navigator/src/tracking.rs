//! Tracking a moving reference.
//!
//! The law of Kanayama, Kimura, Miyazaki and Noguchi (*A Stable Tracking Control Method for an
//! Autonomous Mobile Robot*, ICRA 1990): with the reference's pose in the robot's frame (`e_x`,
//! `e_y`, `e_θ`) and its speeds (`v_r`, `ω_r`),
//!
//! v = `v_r` cos `e_θ` + `k_x` `e_x`,  ω = `ω_r` + `v_r` `k_y` `e_y` + |`v_r`| `k_θ` sin `e_θ`,
//!
//! in which the magnitude keeps the heading stable backwards as well (there is none in the paper,
//! whose reference drives forwards).
//!
//! Its heading error is corrected by driving alone; while the reference turns on the spot, the term
//! `k_turn` sin `e_θ` is added here, so that a turn ends where it should.

use geometry::math;
use geometry::pose::{Pose2, Twist2};
use nalgebra::Vector2;

/// Speed of the reference below which it counts as turning on the spot (m/s).
const SPOT: f64 = 1e-3;

/// Gain of the error ahead (1/s).
pub const K_X: f64 = 4.0;
/// Gain of the lateral error (1/m²).
const K_Y: f64 = 64.0;
/// Gain of the heading error (1/m): critically damped at 2 √`K_Y`.
const K_THETA: f64 = 16.0;
/// Gain of the heading error while the reference turns on the spot (1/s).
const K_TURN: f64 = 4.0;

/// Returns the speeds for a robot at `pose` whose reference is at `reference` and moves with
/// `reference_twist`.
pub fn command(pose: &Pose2, reference: &Pose2, reference_twist: Twist2) -> Twist2 {
    let error = error(pose, reference);
    let (sin, cos) = math::sincos(error.theta);
    let Twist2 { v, omega } = reference_twist;
    let turn = if v.abs() < SPOT && omega != 0.0 {
        K_TURN * sin
    } else {
        0.0
    };
    Twist2 {
        v: v * cos + K_X * error.x,
        omega: omega + v * (K_Y * error.y + v.signum() * K_THETA * sin) + turn,
    }
}

/// Returns the reference's pose in the robot's frame: distance ahead (m), to the left (m), rotation
/// (rad).
pub fn error(pose: &Pose2, reference: &Pose2) -> Pose2 {
    let forward = pose.forward();
    let off: Vector2<f64> = reference.position() - pose.position();
    Pose2 {
        x: forward.dot(&off),
        y: forward.perp(&off),
        theta: math::angle_difference(reference.theta, pose.theta),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use control::go_to::coast;

    #[test]
    fn errors_vanish_along_a_straight_line_and_a_circle() {
        for (v, omega) in [0.2, -0.2]
            .map(|v| [0.0, 0.4, -0.4].map(|w| (v, w)))
            .concat()
        {
            let twist = Twist2::new(v, omega);
            let mut reference = Pose2::new(1.0, 2.0, 0.5);
            let mut pose = Pose2::new(0.97, 2.02, 0.3);
            for _ in 0..400 {
                let twist_of_law = command(&pose, &reference, twist);
                pose = coast(&pose, twist_of_law, 0.05);
                reference = coast(&reference, twist, 0.05);
            }
            let left = error(&pose, &reference);
            let off = left.x.abs().max(left.y.abs()).max(left.theta.abs());
            assert!(off < 1e-6, "{left:?}");
        }
    }

    #[test]
    fn without_error_it_is_the_reference() {
        let pose = Pose2::new(1.0, 2.0, 0.5);
        for twist in [Twist2::new(0.2, -0.3), Twist2::new(0.0, 2.0), Twist2::STOP] {
            assert_eq!(command(&pose, &pose, twist), twist);
        }
    }
}
