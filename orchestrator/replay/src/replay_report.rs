//! Options and report of a replay.

use std::collections::BTreeMap;

use mcap_log::Topics;
use recorder::MessageCounts;
use serde::Serialize;
use viewer::{LiveOptions, LiveTotals};

/// Options of a replay.
#[derive(Debug, Clone)]
pub struct ReplayOptions {
    /// Speed relative to the recording, > 0; infinite for as fast as possible.
    pub rate: f64,
    /// Start of the replayed time (s).
    pub start_s: Option<f64>,
    /// End of the replayed time, included (s).
    pub end_s: Option<f64>,
    /// `true` to start again at the end until interrupted.
    pub again: bool,
    /// Replayed topics.
    pub topics: Topics,
    /// The live server, if requested.
    pub live: Option<LiveOptions>,
    /// `true` to show nothing.
    pub quiet: bool,
}

impl Default for ReplayOptions {
    fn default() -> Self {
        Self {
            rate: 1.0,
            start_s: None,
            end_s: None,
            again: false,
            topics: Topics::default(),
            live: None,
            quiet: false,
        }
    }
}

/// Report of a replay.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ReplayReport {
    /// Name of the scenario.
    pub scenario: String,
    /// Messages sent, including those from before the start.
    pub messages: u64,
    /// Messages sent of the simulated history.
    pub simulated_messages: u64,
    /// Messages from before the start with states that still held.
    pub restored: u64,
    /// Messages that could not be decoded and were omitted.
    pub malformed: u64,
    /// Size of the messages (bytes).
    pub bytes: u64,
    /// Number of different times of the messages.
    pub ticks: u64,
    /// Number of complete replays.
    pub times: u64,
    /// Real time from the opening of the log to the first message (s).
    pub start_up_s: f64,
    /// Part of `start_up_s` for the search of the start (s).
    pub seek_s: f64,
    /// Real time from the first message to the last (s).
    pub wall_time_s: f64,
    /// Totals of the live viewers, if the replay served any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub live: Option<LiveTotals>,
    /// Number of messages by topic.
    pub topics: BTreeMap<String, u64>,
    /// `true` if it was interrupted.
    pub interrupted: bool,
    /// Faults of the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<String>,
}

impl ReplayReport {
    /// Returns the number of messages sent.
    pub fn message_counts(&self) -> MessageCounts {
        MessageCounts::from_topics(&self.topics, |messages| *messages)
    }
}
