//! What can go wrong with a picture.

use std::io;
use std::path::PathBuf;

use ipc_types::cdr::DecodeError;
use mcap::McapError;

use crate::logs::LogsError;

/// Why a picture could not be made of a log.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The log is missing or may not be read.
    #[error("cannot read {}: {source}", path.display())]
    Open {
        /// The log.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The file does not begin like an MCAP file.
    #[error("{} is not an MCAP file", path.display())]
    NotMcap {
        /// The file.
        path: PathBuf,
    },
    /// The file ends before its end mark: the run was killed, or is not over, or the copy is not
    /// whole.
    #[error(
        "{} ends in the middle: the run was killed or is not over yet, or the copy is incomplete",
        path.display()
    )]
    Truncated {
        /// The log.
        path: PathBuf,
    },
    /// A checksum does not fit, or a record makes no sense.
    #[error("{} is damaged: {source}", path.display())]
    Damaged {
        /// The log.
        path: PathBuf,
        /// What the MCAP reader found.
        source: McapError,
    },
    /// An attachment is not one, or its checksum does not fit.
    #[error("{} is damaged: an attachment makes no sense, or its checksum does not fit", path.display())]
    Attachment {
        /// The log.
        path: PathBuf,
    },
    /// An MCAP file of somebody else.
    #[error("{} is an MCAP file, but not a log of protean: it has no {missing}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What every log of ours has.
        missing: &'static str,
    },
    /// The log was recorded by a version whose messages look different.
    #[error(
        "{}: messages of {topic} have the layout {found}, expected {expected}: the log was \
         recorded by another version of protean",
        path.display()
    )]
    Layout {
        /// The log.
        path: PathBuf,
        /// The topic.
        topic: &'static str,
        /// Fingerprint in the log.
        found: String,
        /// Fingerprint of this version.
        expected: String,
    },
    /// A message does not have the form that its schema says.
    #[error("{} is damaged: {source}", path.display())]
    Message {
        /// The log.
        path: PathBuf,
        /// What is wrong with the message.
        source: DecodeError,
    },
    /// The scenario in the log cannot be understood.
    #[error("{}: the scenario in the log: {reason}", path.display())]
    Scenario {
        /// The log.
        path: PathBuf,
        /// Why not.
        reason: String,
    },
    /// The time asked for is not in the log.
    #[error("--at {at}: expected a time from 0 to the end of the run, {end} s")]
    Time {
        /// Time asked for [s].
        at: f64,
        /// Time of the last state [s].
        end: f64,
    },
    /// The picture's file is there already, or is the log, or could not be written.
    #[error(transparent)]
    Output(#[from] Box<LogsError>),
}

impl PictureError {
    /// Whether the picture could not be written, though nothing is wrong with what was asked for.
    pub fn is_output_failure(&self) -> bool {
        matches!(self, Self::Output(error) if matches!(**error, LogsError::Write { .. }))
    }
}
