//! What a navigator asks of the optimiser.

use geometry::pose::Pose2;
use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;
use sim_backend::spec::RobotModel;
use thiserror::Error;

/// A question for a trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryRequest {
    /// Pose at the start.
    pub start: Pose2,
    /// Forward speed at the start (m/s); `None`: free.
    pub start_speed: Option<f64>,
    /// Turning rate at the start (rad/s); `None`: free.
    pub start_turn_rate: Option<f64>,
    /// Where to (m).
    pub goal: Point2<f64>,
    /// Forward speed there (m/s); `None`: free.
    pub goal_speed: Option<f64>,
    /// Body and limits, as far as plans may use them.
    pub model: RobotModel,
    /// What is in the way.
    pub obstacles: Vec<Convex>,
    /// Distance that the robot's centre keeps from it (m).
    pub clearance: f64,
    /// Where the robot's centre may be.
    pub bounds: Aabb,
    /// How deep the start may lie in a grown obstacle (m).
    pub start_tolerance: f64,
}

/// Why there is no trajectory.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum PlanFailure {
    /// The question makes no sense to the optimiser.
    #[error("the optimiser refuses: {0}")]
    Refused(String),
    /// No path leads there.
    #[error("no path leads there")]
    NoPath,
    /// No path can be driven from the speeds that the robot has.
    #[error("no trajectory: {0}")]
    Infeasible(String),
    /// There is no answer: cancelled, or out of time.
    #[error("no answer: {0}")]
    NoAnswer(String),
}
