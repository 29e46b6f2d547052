//! Errors of the measurement of a transport.

use std::time::Duration;

use ipc_types::bus::{BusError, ReceiveError, SendError};

use mission::child_process::ChildError;
use mission::run_directory::RunDirectoryError;

/// Failure to measure a transport.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// An operation of the operating system failed.
    #[error("{what}: {source}")]
    System {
        /// Attempted operation.
        what: String,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// An operation of iceoryx2 failed.
    #[error("iceoryx2: cannot {what}: {reason}")]
    Raw {
        /// Attempted operation.
        what: &'static str,
        /// Error of iceoryx2.
        reason: String,
    },
    /// The receiver failed.
    #[error("the receiver ended: {0}")]
    Receiver(String),
    /// The receiver took too long.
    #[error("the receiver did not {what} within {limit:?}")]
    TooSlow {
        /// Expected action.
        what: &'static str,
        /// Time limit.
        limit: Duration,
    },
    /// The receiver cannot be started.
    #[error(transparent)]
    Child(#[from] ChildError),
    /// The directory for the measurement cannot be created.
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
