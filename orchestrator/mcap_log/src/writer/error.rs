//! Why a run's log cannot be written.

use std::io;
use std::path::PathBuf;

/// Why the log of a run could not be created or written.
#[derive(Debug, thiserror::Error)]
pub enum LogWriteError {
    /// The file is there already and overwriting was not asked for.
    #[error("{path} exists already; choose another name or ask for it to be overwritten")]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// Another run is writing the file.
    #[error("{path} is being written by another run")]
    InUse {
        /// The file.
        path: PathBuf,
    },
    /// The path names something that is not a regular file.
    #[error("{path} is not a regular file")]
    NotAFile {
        /// The path.
        path: PathBuf,
    },
    /// The file could not be created or opened.
    #[error("cannot create the log {path}: {source}")]
    Create {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// A write failed; what was written up to the last flush stays readable.
    #[error("cannot write the log {path}: {source} (it stays readable up to {readable} bytes)")]
    Write {
        /// The file.
        path: PathBuf,
        /// Bytes of complete records that the file was cut back to.
        readable: u64,
        /// What the operating system or the MCAP writer said.
        source: io::Error,
    },
    /// A viewer message could not be encoded.
    #[error("cannot encode a message of {topic} for the log {path}: {reason}")]
    Encode {
        /// The file.
        path: PathBuf,
        /// The viewer topic.
        topic: String,
        /// What the encoder said.
        reason: String,
    },
}
