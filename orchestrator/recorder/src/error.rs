//! Errors of recording.

use ipc_types::bus::{BusError, ReceiveError};
use mcap_log::LogWriteError;

/// Error of recording a run.
#[derive(Debug, thiserror::Error)]
pub enum RecorderError {
    /// The log could not be written.
    #[error(transparent)]
    Log(#[from] LogWriteError),
    /// A topic could not be opened.
    #[error("the recorder cannot subscribe: {0}")]
    Subscribe(#[from] BusError),
    /// A topic could not be read.
    #[error("the recorder cannot read: {0}")]
    Receive(#[from] ReceiveError),
}
