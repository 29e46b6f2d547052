//! Errors of latency measurements.

use std::path::PathBuf;

use mcap_log::LogReadError;

use mission::MissionError;

/// Failure to measure latencies.
#[derive(Debug, thiserror::Error)]
pub enum LatencyError {
    /// The log cannot be read.
    #[error(transparent)]
    Log(Box<LogReadError>),
    /// The log contains nothing to measure.
    #[error("{}: the log contains no {what}", path.display())]
    Lacks {
        /// The log.
        path: PathBuf,
        /// Missing content.
        what: &'static str,
    },
    /// The mission failed.
    #[error(transparent)]
    Mission(Box<MissionError>),
    /// An operation of the operating system failed.
    #[error("{what}: {source}")]
    System {
        /// Attempted operation.
        what: String,
        /// Error of the operating system.
        source: std::io::Error,
    },
}

impl LatencyError {
    /// Returns `true` if the error is caused by the user's input.
    pub fn is_invalid_input(&self) -> bool {
        match self {
            Self::Lacks { .. } => true,
            Self::Log(error) => !matches!(**error, LogReadError::Interrupted),
            Self::Mission(error) => error.is_refusal(),
            Self::System { .. } => false,
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
