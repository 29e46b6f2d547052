//! Errors of writing the log of a run.

use std::io;
use std::path::PathBuf;

/// Error of creating or writing the log of a run.
#[derive(Debug, thiserror::Error)]
pub enum LogWriteError {
    /// The file exists already and may not be overwritten.
    #[error("{path} exists already; choose another name with --out or overwrite it with --force")]
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
    #[error("{path}: cannot be created: {source}")]
    Create {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A write failed; the log stays readable up to the last flush. A log without a flush is removed.
    #[error("{path}: cannot be written: {source} ({})", match *readable {
        0 => "nothing of it is left".to_owned(),
        bytes => format!("it stays readable up to {bytes} bytes"),
    })]
    Write {
        /// The file.
        path: PathBuf,
        /// Length of the complete records to which the file was truncated (bytes).
        readable: u64,
        /// Error of the operating system or of the MCAP writer.
        source: io::Error,
    },
}
