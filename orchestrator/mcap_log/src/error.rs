//! Errors of reading a log.

use std::io;
use std::path::PathBuf;

use platform::file_kind::FileKind;

/// Error of reading a log or the requested part of it.
#[derive(Debug, thiserror::Error)]
pub enum LogReadError {
    /// The log is missing or may not be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Open {
        /// The log.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The file does not begin with the MCAP magic bytes.
    #[error(
        "{} is not an MCAP file{}",
        path.display(),
        kind.map_or_else(String::new, |kind| format!("; {}", kind.help(path)))
    )]
    NotMcap {
        /// The file.
        path: PathBuf,
        /// Its kind, if known.
        kind: Option<FileKind>,
    },
    /// An MCAP file of another program.
    #[error(
        "{} has no {missing}: it is not a Protean log, or its beginning is lost",
        path.display()
    )]
    Foreign {
        /// The file.
        path: PathBuf,
        /// The missing part that every Protean log has.
        missing: &'static str,
    },
    /// The log was recorded by a version with another message layout.
    #[error(
        "{}: messages of {topic} have the layout {found}: expected {expected}; the log was \
         recorded by another version of protean{}; use that version",
        path.display(),
        if version.is_empty() { String::new() } else { format!(" ({version})") }
    )]
    Layout {
        /// The log.
        path: PathBuf,
        /// Version in the log; empty if absent.
        version: String,
        /// The topic.
        topic: String,
        /// Layout hash in the log.
        found: String,
        /// Layout hash of this version.
        expected: String,
    },
    /// The run of the log cannot be executed again.
    #[error("{}: {reason}", path.display())]
    NotRepeatable {
        /// The log.
        path: PathBuf,
        /// Reason and remedy.
        reason: String,
    },
    /// A part of the log exceeds its memory limit.
    #[error("{}: {what}: more than {limit} bytes", path.display())]
    TooLarge {
        /// The log.
        path: PathBuf,
        /// Description of the part.
        what: &'static str,
        /// The limit (bytes).
        limit: usize,
    },
    /// A name on the command line matches no topic.
    #[error("{option} {wanted}: no topic of the log has this name: expected {known}")]
    Topic {
        /// The option.
        option: &'static str,
        /// Requested name.
        wanted: String,
        /// Topics of the log.
        known: String,
    },
    /// Invalid argument.
    #[error("{0}")]
    Argument(String),
    /// The user interrupted the command (Ctrl-C).
    #[error("interrupted")]
    Interrupted,
}
