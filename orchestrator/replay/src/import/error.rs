//! Errors of an import.

use std::path::PathBuf;

use config::Diagnostics;
use mcap_log::LogReadError;
use mission::MissionError;
use ros_messages::CdrError;
use thiserror::Error;

/// Reason why a bag cannot be imported.
#[derive(Debug, Error)]
pub enum ImportError {
    /// A file of the bag is unreadable, or the scenario is refused.
    #[error(transparent)]
    Read(#[from] LogReadError),
    /// The folder of the bag is unreadable.
    #[error("{}: cannot be read: {source}", bag.display())]
    Folder {
        /// The folder.
        bag: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The folder has no file of a bag.
    #[error("{}: no file of a bag: expected FILE.mcap in it", bag.display())]
    Empty {
        /// The folder.
        bag: PathBuf,
    },
    /// A topic on the command line is not one of the scenario.
    #[error("--topic {text}: expected NAME=TOPIC with NAME one of {known}")]
    Option {
        /// The argument.
        text: String,
        /// The names.
        known: String,
    },
    /// The bag lacks a topic.
    #[error(
        "{}: no message of {wanted}: expected at least one of these topics; --topic NAME=TOPIC names others, the bag has {known}",
        bag.display()
    )]
    Missing {
        /// The bag.
        bag: PathBuf,
        /// The topics.
        wanted: String,
        /// Topics of the bag that can be imported, with their types.
        known: String,
    },
    /// A topic has another type.
    #[error("{}: {topic} is {found}: expected {expected}; --topic NAME=TOPIC names another topic", bag.display())]
    Type {
        /// File of the bag.
        bag: PathBuf,
        /// The topic.
        topic: String,
        /// Its type, or its type and encoding.
        found: String,
        /// Expected type.
        expected: &'static str,
    },
    /// A message is invalid.
    #[error("{}: {topic}, message {number}: {fault}", bag.display())]
    Message {
        /// File of the bag.
        bag: PathBuf,
        /// The topic.
        topic: String,
        /// Number of the message in the file, from 1.
        number: u64,
        /// The fault.
        fault: MessageFault,
    },
    /// No message near a tick.
    #[error(
        "{}: {topic}: no message from {from_s:.3} s to {to_s:.3} s: expected one within {max_age_s} s of each tick; --max-age S \
         permits more",
        bag.display()
    )]
    Gap {
        /// The bag.
        bag: PathBuf,
        /// The topic.
        topic: String,
        /// Time of the message before, in the stamps of the bag (s).
        from_s: f64,
        /// Time of the message after (s).
        to_s: f64,
        /// The limit (s).
        max_age_s: f64,
    },
    /// No time at which all topics have messages.
    #[error("{}: its topics were recorded one after another: expected a time with messages of all", bag.display())]
    Apart {
        /// The bag.
        bag: PathBuf,
    },
    /// A frame is not horizontal.
    #[error("{}: frame {frame} is tilted: expected a rotation about the vertical axis", bag.display())]
    Tilted {
        /// The bag.
        bag: PathBuf,
        /// The frame.
        frame: String,
    },
    /// The scenario does not fit the map or the starts of the bag.
    #[error("{}: the scenario does not fit its map, starts and scanners:\n{problems}", bag.display())]
    Scenario {
        /// The bag.
        bag: PathBuf,
        /// Problems of the scenario.
        problems: Diagnostics,
    },
    /// The run failed.
    #[error(transparent)]
    Run(Box<MissionError>),
}

/// Reason why a message is invalid.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MessageFault {
    /// It is not CDR of its type.
    #[error(transparent)]
    Cdr(#[from] CdrError),
    /// A pose or a velocity is not a number, or the orientation not about the vertical axis.
    #[error(
        "its pose or velocity is not in the plane: expected finite numbers and a rotation about the vertical axis"
    )]
    Pose,
    /// The scan has other beams than the first one.
    #[error(
        "its scan has {found} beams from {angle} rad on: expected {beams} from {first} rad on, as the first message"
    )]
    Beams {
        /// Number of its ranges.
        found: usize,
        /// Its first angle (rad).
        angle: f32,
        /// Number of ranges of the first message.
        beams: usize,
        /// First angle of the first message (rad).
        first: f32,
    },
    /// The map is turned.
    #[error("the origin of the map is turned by {0} rad: expected 0")]
    Turned(f64),
    /// The map has not the number of cells that it states.
    #[error("the map has {found} cells: expected {width} × {height}")]
    Cells {
        /// Number of its cells.
        found: usize,
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
}
