//! Errors of replaying or repeating a run.

use mcap_log::LogReadError;

use mission::MissionError;

/// Error of replaying or repeating a run from its log.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The log is unreadable or unsuitable.
    #[error(transparent)]
    Log(#[from] LogReadError),
    /// The run failed.
    #[error(transparent)]
    Mission(Box<MissionError>),
}

impl From<MissionError> for ReplayError {
    fn from(error: MissionError) -> Self {
        Self::Mission(error.into())
    }
}
