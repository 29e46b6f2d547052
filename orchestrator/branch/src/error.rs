//! Errors of branches.

use std::path::PathBuf;

use mcap_log::LogReadError;
use mission::{InProcessError, MissionError};
use replay::ReplayError;
use sweep::SweepError;

/// Error of a branch.
#[derive(Debug, thiserror::Error)]
pub enum BranchError {
    /// The log or the change is unsuitable, or the run failed.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// The run in this program is not that of the log.
    #[error("{}: differs from its run in this program from tick {tick} on: expected the same history; `protean verify` names the cause", log.display())]
    Different {
        /// The log.
        log: PathBuf,
        /// First tick with a difference.
        tick: u64,
    },
    /// The threads cannot be started.
    #[error(transparent)]
    Pool(#[from] SweepError),
}

impl BranchError {
    /// Returns `true` if a robot cannot be at the place that the change gives it.
    pub(crate) fn is_misplaced(&self) -> bool {
        let Self::Replay(ReplayError::Mission(error)) = self else {
            return false;
        };
        matches!(
            **error,
            MissionError::InProcess(InProcessError::Place { .. })
        )
    }
}

impl From<LogReadError> for BranchError {
    fn from(error: LogReadError) -> Self {
        Self::Replay(error.into())
    }
}

impl From<MissionError> for BranchError {
    fn from(error: MissionError) -> Self {
        Self::Replay(error.into())
    }
}
