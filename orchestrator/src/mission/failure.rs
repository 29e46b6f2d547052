//! How a process fails, and in which words that is told.

use std::time::Duration;

/// How a process failed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Failure {
    Exited(String),
    Hung,
    NotReady(Duration),
    NotStarted(String),
}

impl Failure {
    /// What happened to the process, as what follows its name.
    pub(super) fn words(&self, hang_timeout: Duration) -> String {
        match self {
            Self::Exited(how) | Self::NotStarted(how) => how.clone(),
            Self::Hung => format!("did not answer for {hang_timeout:?} and was killed"),
            Self::NotReady(waited) => format!("was not ready within {waited:?} and was killed"),
        }
    }
}
