//! Requests of a navigator to the optimiser.

use geometry::pose::Pose2;
use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;
use robot::spec::RobotModel;
use thiserror::Error;

/// Request for a trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryRequest {
    /// Pose at the start.
    pub start: Pose2,
    /// Forward speed at the start (m/s), negative backwards; `None`: free.
    pub start_speed: Option<f64>,
    /// Turning rate at the start (rad/s); `None`: free.
    pub start_turn_rate: Option<f64>,
    /// Goal (m).
    pub goal: Point2<f64>,
    /// Forward speed there (m/s); `None`: free.
    pub goal_speed: Option<f64>,
    /// Body and limits, as far as plans may use them.
    pub model: RobotModel,
    /// Obstacles.
    pub obstacles: Vec<Convex>,
    /// Minimum distance of the robot's centre from it (m).
    pub clearance: f64,
    /// Bounds of the robot's centre.
    pub bounds: Aabb,
    /// Maximum depth of the start in a grown obstacle (m).
    pub start_tolerance: f64,
}

/// Reasons for the lack of a trajectory.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum PlanFailure {
    /// The optimiser rejects the request as invalid.
    #[error("the optimiser rejected the request: {0}")]
    Refused(String),
    /// The goal is unreachable.
    #[error("the goal is unreachable")]
    NoPath,
    /// No route leads to the goal on a map that is too large for one request.
    #[error("no route to the goal has room for the robot, to the accuracy of the map's grid")]
    NoRoute,
    /// No path is feasible from the robot's present speeds.
    #[error("no trajectory: {0}")]
    Infeasible(String),
    /// No answer: cancelled, or out of time.
    #[error("no answer: {0}")]
    NoAnswer(String),
}
