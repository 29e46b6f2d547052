//! Recorder: writes every message of a run losslessly to one MCAP file that common tools open, and summarises
//! the run.
//!
//! * [`Recorder`] drains the bus on its own thread and drives a [`Recording`];
//! * [`Recording`] checks, counts and hashes messages, and passes them in order to the summary, the log and
//!   an observer; the log is optional;
//! * [`mcap_log::LogWriter`] writes the MCAP file; [`Wakeup`] is the interface to the run.
//!
//! Topics are encoded as ROS 2 CDR whose body consists of the bytes of the message (`ipc_types::cdr`).
//! [`DerivedTopics`] adds derived channels, such as those for viewers. Log time is simulated time.

mod attacked;
mod bus;
pub mod chain;
mod checks;
mod covered;
mod derived;
mod digest;
mod digest_prefixes;
mod error;
mod event_list;
mod field_of_view;
mod link_counts;
mod log;
mod log_thread;
mod message_audit;
mod message_counts;
mod outages;
mod outcome;
mod outcome_words;
mod parts;
mod patrolled;
mod predicted;
mod recording;
mod reorder_buffer;
mod robot_names;
mod robots;
mod run_info;
mod sequence;
mod summary;
mod time_text;
mod verdicts;
mod visits;
mod wakeup;

#[cfg(test)]
mod tests;

// Tests of other crates include the test run of this crate.
#[cfg(test)]
extern crate self as recorder;

pub use bus::Recorder;
pub use derived::{DerivedChannel, DerivedMessages, DerivedTopics};
pub use digest_prefixes::DigestPrefixes;
pub use error::RecorderError;
pub use field_of_view::{FieldOfView, ViewOrigin};
pub use mcap_log::output::ROBOTS_TOPIC;
pub use message_counts::MessageCounts;
pub use outcome_words::outcome_words;
pub use patrolled::PatrolMeasurement;
pub use recording::Recording;
pub use robot_names::robot_names;
pub use run_info::{PatrolInfo, ProcessInfo, RobotInfo, RunInfo, TaskInfo};
pub use summary::{
    AttackOutcome, AttackTotals, CoverageByWay, CoverageOutcome, EventEntry, LapFigures,
    NodeOutcome, Outage, PatrolOutcome, PredictionOutcome, ProcessOutcome, RobotOutcome, Summary,
    TopicCount, WaypointOutcome, role_name, status_name,
};
pub use time_text::time_text;
pub use wakeup::Wakeup;
