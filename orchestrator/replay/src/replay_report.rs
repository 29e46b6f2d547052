//! How a log is to be played, and how it was.

use std::collections::BTreeMap;

use mcap_log::Topics;
use serde::Serialize;
use viewer::LiveTotals;

/// How a log is played.
#[derive(Debug, Clone)]
pub struct ReplayOptions {
    /// Times as fast as recorded, > 0; infinite: as fast as possible.
    pub rate: f64,
    /// From this simulated time on (s).
    pub start_s: Option<f64>,
    /// Up to and with this simulated time (s).
    pub end_s: Option<f64>,
    /// Whether it begins again at its end, until somebody ends it.
    pub again: bool,
    /// Which topics.
    pub topics: Topics,
    /// Port on which live viewers are served, if they are; 0 is any that is free.
    pub live: Option<u16>,
    /// Whether nothing is shown.
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

/// What was played.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Replayed {
    /// The scenario.
    pub scenario: String,
    /// Messages that were sent, those from before the start included.
    pub messages: u64,
    /// Messages from before the start: what lasted.
    pub restored: u64,
    /// Messages that could not be decoded: they are left out.
    pub malformed: u64,
    /// Bytes of the messages.
    pub bytes: u64,
    /// Different times among them.
    pub ticks: u64,
    /// How often it was played to its end.
    pub times: u64,
    /// Real time from the opening of the log to the first message (s).
    pub start_up_s: f64,
    /// The part of it that the way to the start took (s).
    pub seek_s: f64,
    /// Real time from the first message to the last (s).
    pub wall_time_s: f64,
    /// What live viewers got, if they were served.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub live: Option<LiveTotals>,
    /// Messages by topic.
    pub topics: BTreeMap<String, u64>,
    /// Whether it was ended before its end.
    pub interrupted: bool,
    /// What was wrong with the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<String>,
}
