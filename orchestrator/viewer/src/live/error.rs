//! Errors of the live server.

use std::io;

/// Error of serving viewers.
#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    /// The port is not available.
    #[error(
        "cannot serve live viewers on 127.0.0.1:{port}: {source}; choose another port (0 for any \
         that is free)"
    )]
    Listen {
        /// Requested port.
        port: u16,
        /// Error of the operating system.
        source: io::Error,
    },
    /// Another operation failed.
    #[error("cannot serve live viewers: {what}: {source}")]
    System {
        /// Failed operation.
        what: &'static str,
        /// Error of the operating system.
        source: io::Error,
    },
}
