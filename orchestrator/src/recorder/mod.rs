//! The recorder: every message of a run, losslessly, in one MCAP file that the tools people have
//! can open, and what the run amounted to.
//!
//! * [`Recorder`] drains the bus on a thread of its own and drives a [`Recording`];
//! * [`Recording`] orders, checks, counts and fingerprints messages and writes them;
//! * [`Tally`] says what a run amounts to without a log;
//! * [`LogWriter`] is the MCAP file; [`Gate`] and [`Observer`] are the seams to the run.
//!
//! Lossless topics are ROS 2 CDR whose body is the message's bytes (`ipc_types::cdr`); beside them
//! stand `/viewer/…` topics in the viewers' own schemas. Log time is simulated time.

mod beginnings;
mod bus;
mod checks;
mod digest;
mod error;
mod gate;
mod intake;
mod judged;
mod latency;
mod ledger;
mod log_file;
mod log_writer;
mod mirror;
mod options;
mod outages;
mod parts;
mod predicted;
mod recording;
mod sequence;
mod sink;
mod summary;
mod tally;
mod topic_info;
mod viewer;
mod visits;

#[cfg(test)]
pub(crate) mod tests;

pub use beginnings::Beginnings;
pub use bus::Recorder;
pub use error::{LogError, RecorderError};
pub use gate::{Gate, Observer};
pub use latency::SENSE_TO_ACT;
pub(crate) use latency::{Latency, since};
pub use log_writer::{
    ChannelId, ChannelSpec, ChannelTotals, Compression, LogOptions, LogTotals, LogWriter, Manifest,
    ManifestFile,
};
pub use mirror::Mirror;
pub use options::{ProcessInfo, RecorderOptions, RobotInfo};
pub use outages::{Outage, ProcessOutcome};
pub use predicted::PredictionOutcome;
pub use recording::Recording;
pub use summary::{
    CoverageByWay, CoverageOutcome, EventEntry, RobotOutcome, Summary, TopicCount, status_name,
    team_name,
};
pub use tally::Tally;
pub(crate) use topic_info::Role;
pub use viewer::ViewerOptions;
pub use visits::{LapFigures, WaypointOutcome};
