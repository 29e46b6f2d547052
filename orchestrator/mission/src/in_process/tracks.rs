//! Robots that follow a recording in place of their planners' commands.

use std::sync::Arc;

use geometry::pose::{Pose2, Twist2};

/// Recorded motion of a robot, tick by tick.
#[derive(Debug, Clone, Default)]
pub struct Track {
    /// Index of the robot.
    pub robot: usize,
    /// Its pose and velocity at each tick, from 0 on.
    pub poses: Vec<(Pose2, Twist2)>,
    /// Its scan at each tick, one range (m) for each beam of its scanner; empty if the scans are simulated.
    pub scans: Vec<Arc<[f32]>>,
}
