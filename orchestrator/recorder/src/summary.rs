//! What a run amounted to.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use statistics::Percentiles;

use super::outages::ProcessOutcome;
use super::predicted::PredictionOutcome;
use super::visits::WaypointOutcome;

/// What a run amounted to, as `protean run --json` prints it (design §10).
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Fingerprint of the simulated history, 64 hexadecimal digits.
    pub digest: String,
    /// Last tick of the world.
    pub ticks: u64,
    /// Simulated time of that tick (s).
    pub sim_time_s: f64,
    /// What became of every robot, by its index.
    pub robots: Vec<RobotOutcome>,
    /// Share of the verdicts on all evaders that said "escape possible"; absent unless a referee
    /// ran.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub escape_possible_fraction: Option<f64>,
    /// Time from which on no evader could be sure of an escape any more (s); absent unless a referee
    /// ran and that came about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub escape_impossible_from_s: Option<f64>,
    /// What happened, in order.
    pub events: Vec<EventEntry>,
    /// Events that the list leaves out because it is full.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub events_omitted: u64,
    /// The area visited, if the rules account for it: as last reported.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coverage: Option<CoverageOutcome>,
    /// How well observers foretold where robots would be, by observer, robot, method and time ahead;
    /// absent unless one ran.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub predictions: Option<Vec<PredictionOutcome>>,
    /// The processes that failed, by their index; absent if none did.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub processes: Vec<ProcessOutcome>,
    /// Every channel of the log that holds messages.
    pub topics: BTreeMap<String, TopicCount>,
    /// Latencies by name (µs).
    pub latency_us: BTreeMap<String, Percentiles>,
    /// The log; empty if there is none because nothing happened.
    pub log: PathBuf,
    /// Its size (bytes).
    pub log_bytes: u64,
}

/// What became of a robot.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct RobotOutcome {
    /// Its name.
    pub name: String,
    /// `neutral`, `police` or `evader`.
    pub team: String,
    /// `active`, `caught`, `escaped`, `timed_out`, `goal_reached` or `disabled`.
    pub outcome: String,
    /// When that was decided, or the end of the run for an active one (s).
    pub time_s: f64,
    /// Path length driven (m).
    pub distance_m: f64,
    /// Contact episodes.
    pub contacts: u32,
    /// Times it was stopped for want of a fresh command.
    #[serde(default)]
    pub fail_safe_stops: u32,
    /// Ticks that it was stopped for, for want of a valid one.
    #[serde(default)]
    pub fail_safe_ticks: u64,
    /// Share of the verdicts on this evader that said "escape possible"; absent unless a referee
    /// judged it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub escape_possible_fraction: Option<f64>,
    /// Time from which on it could not be sure of an escape any more (s); absent if it escaped, or
    /// could have in the end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub escape_impossible_from_s: Option<f64>,
    /// What became of its waypoints; absent unless its planner visits waypoints.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub waypoints: Option<WaypointOutcome>,
}

/// The area visited.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CoverageOutcome {
    /// Visited part of the free area, 0…1.
    pub fraction: f64,
    /// Visited part of the area that the robots can visit at all, 0…1.
    pub coverable_fraction: f64,
    /// Free area (m²).
    pub free_m2: f64,
    /// Visited area (m²).
    pub visited_m2: f64,
    /// Mean time since the last visit over the coverable area (s).
    pub mean_idleness_s: f64,
    /// Longest that any coverable place has waited for a visit (s).
    pub worst_idleness_s: f64,
    /// Standard deviation of the visits of a coverable cell, divided by their mean.
    pub unevenness: f64,
    /// Way driven by the robots that count, together (m).
    pub way_m: f64,
    /// What part of the area that the robots can visit had been visited when that way had become
    /// 250, 500, 1000 and 2000 m; as far as the run came.
    pub by_way: Vec<CoverageByWay>,
}

/// The area visited along a way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CoverageByWay {
    /// The way (m).
    pub way_m: f64,
    /// Visited part of the area that can be visited, 0…1; between two reports, the straight line.
    pub coverable_fraction: f64,
}

/// One event.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EventEntry {
    /// When (s).
    pub time_s: f64,
    /// What: `WorldEvent::NAMES`.
    pub kind: String,
    /// Name of the robot it happened to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// The other robot's index, the obstacle's id or the exit's index, by kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub other: Option<u32>,
    /// Where, x (m).
    pub x: f64,
    /// Where, y (m).
    pub y: f64,
    /// By kind; 0 when it has none.
    pub value: f64,
}

/// How much was recorded of a topic.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TopicCount {
    /// Messages in the log.
    pub messages: u64,
    /// Their bytes, uncompressed.
    pub bytes: u64,
    /// Messages that are missing by the sequence numbers.
    pub gaps: u64,
    /// Messages that failed the checks. They are in the log all the same, but for those with a number
    /// of elements that no reader could decode.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub rejected: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde wants a reference")]
fn is_zero(n: &u64) -> bool {
    *n == 0
}

/// Simulated nanoseconds as seconds.
pub(super) fn seconds(ns: u64) -> f64 {
    ns as f64 / 1e9
}

/// Name of a team's code in `RobotState`.
pub fn team_name(team: u8) -> &'static str {
    ["neutral", "police", "evader"]
        .get(usize::from(team))
        .copied()
        .unwrap_or("unknown")
}

/// Name of a status code in `RobotState`.
pub fn status_name(status: u8) -> &'static str {
    [
        "active",
        "caught",
        "escaped",
        "timed_out",
        "goal_reached",
        "disabled",
    ]
    .get(usize::from(status))
    .copied()
    .unwrap_or("unknown")
}
