//! Why latencies could not be measured.

use std::path::PathBuf;

use mcap_log::LogReadError;

use super::link::LinkError;
use mission::MissionError;

/// Why latencies could not be measured.
#[derive(Debug, thiserror::Error)]
pub enum LatencyError {
    /// The log cannot be read.
    #[error(transparent)]
    Log(Box<LogReadError>),
    /// There is nothing to measure in the log.
    #[error("{}: the log holds no {what}", path.display())]
    Lacks {
        /// The log.
        path: PathBuf,
        /// What is missing.
        what: &'static str,
    },
    /// The mission failed.
    #[error(transparent)]
    Mission(Box<MissionError>),
    /// A baseline could not be measured.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The system refused something.
    #[error("{what}: {source}")]
    System {
        /// What was attempted.
        what: String,
        /// What the system said.
        source: std::io::Error,
    },
}

impl LatencyError {
    /// Whether somebody's input is to blame, and not the measuring.
    pub fn is_invalid_input(&self) -> bool {
        match self {
            Self::Lacks { .. } => true,
            Self::Log(error) => !matches!(**error, LogReadError::Interrupted),
            Self::Mission(_) | Self::Link(_) | Self::System { .. } => false,
        }
    }
}

impl From<LogReadError> for LatencyError {
    fn from(error: LogReadError) -> Self {
        Self::Log(Box::new(error))
    }
}

impl From<MissionError> for LatencyError {
    fn from(error: MissionError) -> Self {
        Self::Mission(Box::new(error))
    }
}
