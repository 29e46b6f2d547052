//! Why a transport could not be measured.

use std::time::Duration;

use ipc_types::bus::{BusError, ReceiveError, SendError};

use mission::child_process::ChildError;
use mission::run_directory::RunDirectoryError;

/// Why a transport could not be measured.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The system refused something.
    #[error("{what}: {source}")]
    System {
        /// What was attempted.
        what: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// iceoryx2 refused something.
    #[error("iceoryx2: cannot {what}: {reason}")]
    Raw {
        /// What was attempted.
        what: &'static str,
        /// What it said.
        reason: String,
    },
    /// The receiver failed.
    #[error("the receiver ended: {0}")]
    Receiver(String),
    /// The receiver took too long.
    #[error("the receiver did not {what} within {limit:?}")]
    TooSlow {
        /// What it should have done.
        what: &'static str,
        /// Time that it had.
        limit: Duration,
    },
    /// The receiver cannot be started.
    #[error(transparent)]
    Child(#[from] ChildError),
    /// There is no directory for the measurement.
    #[error(transparent)]
    Space(#[from] RunDirectoryError),
    /// The bus cannot be set up.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// A message cannot be sent.
    #[error(transparent)]
    Send(#[from] SendError),
    /// A message cannot be received.
    #[error(transparent)]
    Receive(#[from] ReceiveError),
}

impl LinkError {
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
