//! The recorder: every message of a run, losslessly, in one MCAP file that the tools people have
//! can open, and what the run amounted to.
//!
//! * [`Recorder`] drains the bus on a thread of its own and drives a [`Recording`];
//! * [`Recording`] checks, counts and fingerprints messages, and hands them on in their order: to the
//!   outcome of the run, to the log, to an observer. A run without a log has the same, but for the
//!   log;
//! * [`mcap_log::LogWriter`] is the MCAP file; [`Wakeup`] is the seam to the run.
//!
//! Lossless topics are ROS 2 CDR whose body is the message's bytes (`ipc_types::cdr`); beside them
//! stand the channels that [`DerivedTopics`] makes from the messages, such as those for viewers. Log
//! time is simulated time.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod bus;
pub mod chain;
mod checks;
mod covered;
mod derived;
mod digest;
mod digest_prefixes;
mod error;
mod event_list;
mod log;
mod message_audit;
mod outages;
mod outcome;
mod parts;
mod predicted;
mod recording;
mod reorder_buffer;
mod robots;
mod run_info;
mod sequence;
mod summary;
mod verdicts;
mod visits;
mod wakeup;

#[cfg(test)]
mod tests;

// Tests of other crates include the made-up run of these.
#[cfg(test)]
extern crate self as recorder;

pub use bus::Recorder;
pub use derived::{DerivedChannel, DerivedMessages, DerivedTopics};
pub use digest_prefixes::DigestPrefixes;
pub use error::RecorderError;
pub use recording::Recording;
pub use run_info::{ProcessInfo, RobotInfo, RunInfo};
pub use summary::{
    CoverageByWay, CoverageOutcome, EventEntry, LapFigures, Outage, PredictionOutcome,
    ProcessOutcome, RobotOutcome, Summary, TopicCount, WaypointOutcome, status_name, team_name,
};
pub use wakeup::Wakeup;
