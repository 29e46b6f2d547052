//! Why something could not be measured.

use std::time::Duration;

use ipc_types::bus::{BusError, ReceiveError, SendError};
use kit::lockstep::PageError;

use crate::mission::children::ChildError;
use crate::mission::spaces::SpaceError;

/// Why something could not be measured.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// Ended from outside.
    #[error("interrupted")]
    Interrupted,
    /// It took too long.
    #[error("{what}: not done within {limit:?}")]
    TooSlow {
        /// What was waited for.
        what: String,
        /// For how long.
        limit: Duration,
    },
    /// The system refused something.
    #[error("{what}: {source}")]
    System {
        /// What was attempted.
        what: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// A process of the measurement failed.
    #[error("{process}: {how}")]
    Process {
        /// Which one.
        process: String,
        /// How it ended, with its last words.
        how: String,
    },
    /// iceoryx2 refused something.
    #[error("iceoryx2: cannot {what}: {reason}")]
    Raw {
        /// What was attempted.
        what: &'static str,
        /// What it said.
        reason: String,
    },
    /// A message did not arrive.
    #[error("{0}: a message is missing")]
    Lost(&'static str),
    /// A process cannot be started.
    #[error(transparent)]
    Child(#[from] ChildError),
    /// No directory for the measurement.
    #[error(transparent)]
    Space(#[from] SpaceError),
    /// The bus cannot be set up.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// A message cannot be sent.
    #[error(transparent)]
    Send(#[from] SendError),
    /// A message cannot be received.
    #[error(transparent)]
    Receive(#[from] ReceiveError),
    /// The turn page cannot be set up.
    #[error(transparent)]
    Page(#[from] PageError),
}

impl BenchError {
    pub(super) fn system(what: impl Into<String>) -> impl FnOnce(std::io::Error) -> Self {
        let what = what.into();
        move |source| Self::System { what, source }
    }

    pub(super) fn raw<E: core::fmt::Debug>(what: &'static str) -> impl FnOnce(E) -> Self {
        move |reason| Self::Raw {
            what,
            reason: format!("{reason:?}"),
        }
    }
}
