//! The problem, in SI units and one frame.

use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;
use trajectory_problem::RobotLimits;

/// A place that the robot keeps away from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeepOutDisc<'a> {
    /// The obstacle (m).
    pub shape: &'a Convex,
    /// Minimum distance of the robot's centre (m), ≥ 0.
    pub distance: f64,
}

/// A minimum-time problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem<'a> {
    /// Position at the start (m).
    pub start: Point2<f64>,
    /// Heading at the start (rad).
    pub start_heading: f64,
    /// Speed at the start (m/s), and turning rate (rad/s); `None`: free.
    pub start_speeds: [Option<f64>; 2],
    /// Position of the goal (m).
    pub goal: Point2<f64>,
    /// Heading at the goal (rad), any of its representatives; `None`: free.
    pub goal_heading: Option<f64>,
    /// Speed at the goal (m/s); `None`: free.
    pub goal_speed: Option<f64>,
    /// Limits of the robot.
    pub limits: RobotLimits,
    /// Allowed positions between the ends.
    pub bounds: Aabb,
    /// Obstacles.
    pub obstacles: Vec<KeepOutDisc<'a>>,
}

/// Pose and speeds at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Position (m).
    pub at: Point2<f64>,
    /// Heading (rad).
    pub theta: f64,
    /// Forward speed (m/s).
    pub v: f64,
    /// Turning rate (rad/s).
    pub omega: f64,
}
