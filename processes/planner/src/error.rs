//! Reasons why there is no planner for a robot.

use std::error::Error;

use parameters::ParamsError;
use thiserror::Error;

/// Reason why there is no planner for a robot.
#[derive(Debug, Error)]
pub enum PlannerError {
    /// A parameter does not fit the others, the robot or the task.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// The algorithm cannot drive this robot.
    #[error("{robot}: {source}")]
    Robot {
        /// Name of the robot.
        robot: String,
        /// Reason, with the value and what is expected.
        source: Box<dyn Error + Send + Sync>,
    },
    /// Another error of the algorithm.
    #[error(transparent)]
    Algorithm(Box<dyn Error + Send + Sync>),
}

impl PlannerError {
    /// Returns the error about a robot with this name.
    pub fn of_robot(robot: &str, reason: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Robot {
            robot: robot.to_owned(),
            source: reason.into(),
        }
    }

    /// Returns the error of an algorithm.
    pub fn algorithm(reason: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Algorithm(reason.into())
    }
}
