//! Reports of a planner on its robot, beside commands and waypoints.

use nalgebra::Point2;

/// Kind of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RobotEventKind {
    /// A guard has sighted an intruder and pursues it.
    Sighted,
    /// A guard has lost sight of its intruder for too long and gives up.
    Lost,
    /// A guard is back on its patrol.
    Returned,
}

/// Report about the planner's own robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotEvent {
    /// Kind.
    pub kind: RobotEventKind,
    /// Index of the other robot.
    pub other: usize,
    /// Place (m): where the intruder is believed to be, or where the guard takes up its patrol.
    pub at: Point2<f64>,
}
