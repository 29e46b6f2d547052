//! What a run amounted to.

use std::collections::BTreeMap;
use std::path::PathBuf;

use ipc_types::consumer::Consumer;
use serde::{Deserialize, Serialize};
use statistics::Percentiles;

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
    /// How well observers predicted where robots would be, by observer, robot, method and time ahead;
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

/// Makes a part of the summary of the messages that passed the checks.
pub(super) trait OutcomePart: Consumer + Send {
    /// Enters what it found.
    fn finish(self: Box<Self>, summary: &mut Summary);
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

/// What became of a robot's waypoints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WaypointOutcome {
    /// Waypoints that the robot reached.
    pub reached: u64,
    /// Left out, because they lay inside an obstacle that the robot knows.
    pub inside_obstacle: u64,
    /// Left out, because they were not reached in the time allowed.
    pub timed_out: u64,
    /// Left out, because no way leads there.
    pub unreachable: u64,
    /// Greatest distance that a robot's centre kept from a waypoint that counts as reached (m).
    pub farthest_m: f64,
    /// Laps, from the first waypoint of the route to the last.
    pub laps: u32,
    /// Longest time that one of them took (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longest_lap_s: Option<f64>,
    /// The laps through all their waypoints, those put in included; absent without a lap.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planned: Option<LapFigures>,
    /// The laps as the robot drove them; absent without a lap.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub driven: Option<LapFigures>,
}

impl WaypointOutcome {
    /// Waypoints left out, of all that ended, 0…1; 0 if there are none.
    pub fn left_out_share(&self) -> f64 {
        let left_out = self.inside_obstacle + self.timed_out + self.unreachable;
        let all = left_out + self.reached;
        if all == 0 {
            0.0
        } else {
            left_out as f64 / all as f64
        }
    }
}

/// What laps are like: means over the laps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LapFigures {
    /// Length (m).
    pub length_m: f64,
    /// Mean distance from where a robot would be that kept to the route, at equal times (MAE) (m).
    pub mae_m: f64,
    /// Changes of direction in a lap.
    pub turns: f64,
    /// Mean change of direction (MAA), in [0, π] (rad).
    pub maa: f64,
    /// Mean change of direction, each folded to an acute angle, in [0, π/2] (rad).
    pub maa_fold: f64,
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

/// How well one method predicted where one robot would be, for one time ahead.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PredictionOutcome {
    /// Index of the observer's process.
    pub observer: u32,
    /// Name of the robot.
    pub robot: String,
    /// Name of the method: `Prediction::METHODS`.
    pub method: String,
    /// How far ahead (s).
    pub horizon_s: f64,
    /// Predictions that came due.
    pub predictions: u64,
    /// Times at which the method could not say.
    pub without: u64,
    /// Mean error (m); absent without a prediction, like the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean_m: Option<f64>,
    /// Median error (m).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub median_m: Option<f64>,
    /// Root mean square error (m).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rms_m: Option<f64>,
    /// Goals that the method made out.
    pub goals_observed: u32,
    /// When it first knew the key (s); absent if it never did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key_recovered_s: Option<f64>,
    /// Goals that it had made out by then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key_recovered_after: Option<u32>,
}

/// What became of a process that failed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProcessOutcome {
    /// Its name.
    pub name: String,
    /// How often it was started again and came back.
    pub restarts: u32,
    /// Ticks that were done without it.
    pub ticks_absent: u64,
    /// Whether it was not started again after the last failure.
    pub given_up: bool,
    /// Every failure, in order.
    pub outages: Vec<Outage>,
}

/// A time without a process.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Outage {
    /// The first tick that it did not do.
    pub left_tick: u64,
    /// Simulated time of that tick (s).
    pub left_time_s: f64,
    /// Why: `was ended by signal 9`.
    pub reason: String,
    /// The first tick that it did again; absent if it never came back.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub back_tick: Option<u64>,
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
