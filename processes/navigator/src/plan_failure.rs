//! Failures of requests to the optimiser.

use thiserror::Error;

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
