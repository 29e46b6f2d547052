//! A watch over the drive to a goal: it must not go on without progress.

use geometry::pose::Pose2;

use super::LEAVE_MARGIN;
use super::trail::Trail;

/// Distance driven along the own trail without progress after which the robot goes in circles, in grown
/// radii.
const MAX_AGAIN: f64 = 10.0;

/// The progress towards a goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress {
    /// Minimum distance from the goal so far (m).
    least: f64,
    /// The trail since then.
    trail: Trail,
}

impl Default for Progress {
    fn default() -> Self {
        Self {
            least: f64::INFINITY,
            trail: Trail::default(),
        }
    }
}

impl Progress {
    /// Adds the next pose and its distance from the goal (m); returns `true` if the robot has driven along its
    /// own trail for long since it last came nearer to the goal. `grown` is the radius by which obstacles are
    /// grown (m).
    ///
    /// A bounded area has room for a trail of bounded length, so every endless drive is found.
    pub(super) fn stalls(&mut self, pose: &Pose2, distance: f64, grown: f64) -> bool {
        if distance < self.least - LEAVE_MARGIN {
            *self = Self {
                least: distance,
                trail: Trail::default(),
            };
        }
        self.trail.add(pose.position(), pose.forward(), grown);
        self.trail.again() >= MAX_AGAIN * grown
    }
}
