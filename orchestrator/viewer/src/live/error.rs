//! Why a run cannot be shown live.

use std::io;

/// Why viewers cannot be served.
#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    /// The port cannot be had.
    #[error(
        "cannot serve live viewers on 127.0.0.1:{port}: {source}; choose another port (0 for any \
         that is free)"
    )]
    Listen {
        /// The port that was asked for.
        port: u16,
        /// What the system output.
        source: io::Error,
    },
    /// The system refused something else.
    #[error("cannot serve live viewers: {what}: {source}")]
    System {
        /// What was attempted.
        what: &'static str,
        /// What the system output.
        source: io::Error,
    },
}
