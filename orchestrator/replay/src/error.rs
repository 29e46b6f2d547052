//! Errors of replaying or repeating a run.

use std::path::PathBuf;

use mcap_log::LogReadError;

use crate::bag_fault::BagFault;
use mission::MissionError;

/// Error of replaying or repeating a run from its log.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The log is unreadable or unsuitable.
    #[error(transparent)]
    Log(#[from] LogReadError),
    /// A bag cannot be imported.
    #[error("{}: {fault}", path.display())]
    Bag {
        /// The bag, or its file.
        path: PathBuf,
        /// The fault.
        fault: BagFault,
    },
    /// The run failed.
    #[error(transparent)]
    Mission(Box<MissionError>),
}

impl From<MissionError> for ReplayError {
    fn from(error: MissionError) -> Self {
        Self::Mission(error.into())
    }
}
