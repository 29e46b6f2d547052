//! Ways in which a process fails, and their words.

use std::time::Duration;

/// A failure of a process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Failure {
    /// It ended; how, in words.
    Exited(String),
    /// It did not answer for this long.
    Hung(Duration),
    /// It was not ready within this time.
    NotReady(Duration),
    /// It could not be started again; why, in words.
    NotStarted(String),
}

impl Failure {
    /// What happened to the process, as what follows its name.
    pub(super) fn words(&self) -> String {
        match self {
            Self::Exited(how) | Self::NotStarted(how) => how.clone(),
            Self::Hung(waited) => format!("did not answer for {waited:?} and was killed"),
            Self::NotReady(waited) => format!("was not ready within {waited:?} and was killed"),
        }
    }
}
