//! Errors of branches.

use std::path::PathBuf;

use mcap_log::LogReadError;
use mission::{InProcessError, MissionError};
use replay::ReplayError;

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
    /// A continuation failed, or its process was killed.
    #[error("the continuation from {at} s with stream {seed} has no outcome: {reason}")]
    Continuation {
        /// Number of its random streams.
        seed: u64,
        /// Its first moment (s).
        at: String,
        /// Error of its run.
        reason: String,
    },
    /// The system makes no copy of this process.
    #[error("continuations run in copies of this process: {0}")]
    Copy(std::io::Error),
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
