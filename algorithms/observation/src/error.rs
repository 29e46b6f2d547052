//! Errors of observations.

use thiserror::Error;

/// Reason why a robot has no such observation.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum LayoutError {
    /// The contents have an unknown name.
    #[error(
        "observation {given:?}: expected one of state, scan, belief, path, potential, or several of them as in state+scan"
    )]
    Parts {
        /// The name.
        given: String,
    },
    /// Unknown meaning of actions.
    #[error("action = {given:?}: expected one of twist, tune, residual")]
    Action {
        /// The text.
        given: String,
    },
    /// Actions that tune or correct the potential-field evader are for evaders.
    #[error("actions tune and residual: robot {robot} is no evader")]
    NoEvader {
        /// Name of the robot.
        robot: String,
    },
    /// No robot has this index.
    #[error("robot {robot}: expected an index below {robots}")]
    Robot {
        /// The index.
        robot: usize,
        /// Number of robots.
        robots: usize,
    },
    /// The robot has no range scan.
    #[error(
        "observation scan: robot {robot} has no range scan: expected `scan = {{}}` in the scenario"
    )]
    NoScan {
        /// Name of the robot.
        robot: String,
    },
    /// The robot has no opponents.
    #[error("observation belief: robot {robot} has no opponents to have beliefs about")]
    NoOpponents {
        /// Name of the robot.
        robot: String,
    },
}

/// Reason why an observation cannot be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum WriteError {
    /// The slice has another length.
    #[error("an observation of {given} numbers: expected {expected}")]
    Length {
        /// Length of the layout.
        expected: usize,
        /// Length of the slice.
        given: usize,
    },
    /// The view has no such robot.
    #[error("the view does not list robot {robot}, or one of its numbers is not finite")]
    Robot {
        /// Index of the robot.
        robot: usize,
    },
}
