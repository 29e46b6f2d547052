//! Why a log cannot be read.

use std::io;
use std::path::PathBuf;

/// Why a log, or the wanted part of it, could not be read.
#[derive(Debug, thiserror::Error)]
pub enum LogReadError {
    /// The log is missing or may not be read.
    #[error("cannot read {}: {source}", path.display())]
    Open {
        /// The log.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The file does not begin like an MCAP file.
    #[error("{} is not an MCAP file{}", path.display(), if *empty { ": it is empty" } else { "" })]
    NotMcap {
        /// The file.
        path: PathBuf,
        /// Whether there is nothing in it.
        empty: bool,
    },
    /// An MCAP file of another program.
    #[error(
        "{} holds no {missing}: it is not a log of protean, or its beginning is lost",
        path.display()
    )]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What every log of ours has.
        missing: &'static str,
    },
    /// The log was recorded by a version whose messages look different.
    #[error(
        "{}: messages of {topic} have the layout {found}, expected {expected}: the log was \
         recorded by another version of protean{}; use that version",
        path.display(),
        if version.is_empty() { String::new() } else { format!(" ({version})") }
    )]
    Layout {
        /// The log.
        path: PathBuf,
        /// The version that the log names, or nothing.
        version: String,
        /// The topic.
        topic: String,
        /// Fingerprint in the log.
        found: String,
        /// Fingerprint of this version.
        expected: String,
    },
    /// The log cannot be executed again.
    #[error("{}: {reason}", path.display())]
    NotRepeatable {
        /// The log.
        path: PathBuf,
        /// Why not, and what to do.
        reason: String,
    },
    /// A file would have to hold more than memory allows.
    #[error("{}: {what}: more than {limit} bytes", path.display())]
    TooLarge {
        /// The log.
        path: PathBuf,
        /// What is so large.
        what: &'static str,
        /// The limit (bytes).
        limit: usize,
    },
    /// A name on the command line fits no topic.
    #[error("{option} {wanted}: no topic of the log has this name; it has {known}")]
    Topic {
        /// The option.
        option: &'static str,
        /// What was asked for.
        wanted: String,
        /// What there is.
        known: String,
    },
    /// An argument makes no sense.
    #[error("{0}")]
    Argument(String),
    /// Ctrl-C.
    #[error("interrupted; nothing was written")]
    Interrupted,
}
