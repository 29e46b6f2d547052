//! Turns on the spot, arcs and straight lines.

use geometry::math;
use geometry::pose::Pose2;

/// Turns (rad) and lengths (m) below this are left out.
pub const NOTHING: f64 = 1e-9;

/// A motion of the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// A turn on the spot by an angle (rad).
    Turn(f64),
    /// An arc or a straight line.
    Drive {
        /// Length (m), negative backwards.
        length: f64,
        /// Change of the heading per length (1/m): positive if the arc's centre is to the left.
        kappa: f64,
    },
}

impl Motion {
    /// A turn on the spot by an angle (rad); `None` if it is nothing.
    pub fn turn(angle: f64) -> Option<Self> {
        (angle.abs() > NOTHING).then_some(Self::Turn(angle))
    }

    /// An arc or a straight line of a length (m) and a curvature (1/m), as in [`Self::Drive`]; `None` if
    /// it is nothing.
    pub fn drive(length: f64, kappa: f64) -> Option<Self> {
        (length.abs() > NOTHING).then_some(Self::Drive { length, kappa })
    }

    /// The pose after this motion, its heading not wrapped: it tells how far the robot has turned.
    pub fn end(&self, from: &Pose2) -> Pose2 {
        match *self {
            Self::Turn(angle) => Pose2 {
                theta: from.theta + angle,
                ..*from
            },
            Self::Drive { length, kappa } => {
                let turn = kappa * length;
                let (sin, cos) = math::sincos(from.theta + 0.5 * turn);
                let half = 0.5 * turn;
                let chord = if half.abs() < 1e-4 {
                    length * (1.0 - half * half / 6.0)
                } else {
                    length * math::sin(half) / half
                };
                Pose2 {
                    x: from.x + chord * cos,
                    y: from.y + chord * sin,
                    theta: from.theta + turn,
                }
            }
        }
    }
}
