//! Errors of doing a run once more.

use mcap_log::LogReadError;

use mission::MissionError;

/// Why a run could not be done once more from its log.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The log cannot be read, or cannot be done once more.
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
