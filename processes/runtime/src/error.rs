//! Errors that end a process.

use ipc_types::bus::{BusError, ReceiveError, SendError};

use crate::config::ConfigError;
use crate::declaration::DeclarationError;
use crate::lockstep::BarrierError;

/// Errors after which a process cannot continue.
#[derive(Debug, thiserror::Error)]
pub enum ProcessError {
    /// Its configuration cannot be used.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// Its parameters do not fit its kind.
    #[error("parameters of {process} (kind {kind}): {reason}")]
    Params {
        /// Name of the process.
        process: String,
        /// Its kind.
        kind: String,
        /// Description of the fault.
        reason: String,
    },
    /// The run lacks an input that it requires.
    #[error("{process} {lack}: expected {expected}")]
    Input {
        /// Name of the process, and its kind.
        process: String,
        /// Input and what is missing, in words.
        lack: String,
        /// Part that the scenario lacks.
        expected: &'static str,
    },
    /// A topic that it declares.
    #[error(transparent)]
    Declaration(#[from] DeclarationError),
    /// The bus cannot be opened.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// A message cannot be sent.
    #[error(transparent)]
    Send(#[from] SendError),
    /// A message cannot be received.
    #[error(transparent)]
    Receive(#[from] ReceiveError),
    /// The tick barrier cannot be used.
    #[error(transparent)]
    Barrier(#[from] BarrierError),
    /// A system call failed.
    #[error("{what}: {source}")]
    System {
        /// Attempted operation.
        what: &'static str,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// Another process violated the protocol.
    #[error("protocol: {0}")]
    Protocol(String),
    /// Request to end in the middle of the run, by SIGTERM or because the orchestrator has gone.
    #[error("terminated in the middle of the run")]
    Terminated,
    /// A program outside of this one, which runs the process; the error names the process.
    #[error(transparent)]
    Outside(Box<dyn core::error::Error + Send + Sync>),
    /// The algorithm cannot continue.
    #[error("{0}")]
    Algorithm(String),
}

impl ProcessError {
    /// Wraps a failed system call.
    pub fn system(what: &'static str, source: impl Into<std::io::Error>) -> Self {
        Self::System {
            what,
            source: source.into(),
        }
    }
}
