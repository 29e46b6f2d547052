//! Summary of a run.

use std::collections::BTreeMap;
use std::path::PathBuf;

use ipc_types::consumer::Consumer;
use ipc_types::event_names::EventNames;
use ipc_types::messages::world::WorldEvent;
use serde::{Deserialize, Serialize};
use statistics::Percentiles;

use super::message_counts::MessageCounts;

/// Summary of a run, as `protean run --json` prints it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Digest of the simulated history, 64 hexadecimal digits.
    pub digest: String,
    /// Last tick of the world.
    pub ticks: u64,
    /// Simulated time of that tick (s).
    pub sim_time_s: f64,
    /// Outcomes of the robots, by index.
    pub robots: Vec<RobotOutcome>,
    /// Share of the verdicts "escape possible" on all evaders; absent unless a referee ran.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub escape_possible_fraction: Option<f64>,
    /// Time from which on no evader had a guaranteed escape (s); absent without a referee or such a time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub escape_impossible_from_s: Option<f64>,
    /// Events, in order.
    pub events: Vec<EventEntry>,
    /// Number of events omitted because the list is full.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub events_omitted: u64,
    /// Last reported coverage, if the rules account for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coverage: Option<CoverageOutcome>,
    /// Idleness of the contours that are patrolled; absent without one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub patrols: Vec<PatrolOutcome>,
    /// Attacks, in order, each with its judgement; absent without one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub attacks: Vec<AttackOutcome>,
    /// Accuracy of predictions, by observer, robot, method and horizon; absent unless an observer ran.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub predictions: Option<Vec<PredictionOutcome>>,
    /// Messages on the links of the scenario, by topic and sender; absent without links.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub links: Vec<LinkOutcome>,
    /// Processes that failed, by index; absent if none failed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub processes: Vec<ProcessOutcome>,
    /// Counts of every channel of the log that contains messages.
    pub topics: BTreeMap<String, TopicCount>,
    /// Latencies by name (µs).
    pub latency_us: BTreeMap<String, Percentiles>,
    /// Path of the log; empty without a log.
    pub log: PathBuf,
    /// Size of the log (bytes).
    pub log_bytes: u64,
}

impl Summary {
    /// Returns the number of messages.
    pub fn message_counts(&self) -> MessageCounts {
        MessageCounts::from_topics(&self.topics, |topic| topic.messages)
    }
}

/// A part of the summary, made from the messages that passed the checks.
pub(super) trait OutcomePart: Consumer + Send {
    /// Enters the result into the summary.
    fn finish(self: Box<Self>, summary: &mut Summary);
}

/// Outcome of a robot.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct RobotOutcome {
    /// Name.
    pub name: String,
    /// Name of its team.
    pub team: String,
    /// Role of its team, `neutral`, `pursuer` or `evader`. [`Self::role`] also reads outcomes of before, without it.
    #[serde(default)]
    pub role: String,
    /// `active`, `caught`, `escaped`, `timed_out`, `goal_reached` or `disabled`.
    pub outcome: String,
    /// Time of the outcome, or of the end of the run for an active robot (s).
    pub time_s: f64,
    /// Path length driven (m).
    pub distance_m: f64,
    /// Number of contact episodes.
    pub contacts: u32,
    /// Number of fail-safe stops (no fresh command).
    #[serde(default)]
    pub fail_safe_stops: u32,
    /// Number of ticks in fail-safe stops.
    #[serde(default)]
    pub fail_safe_ticks: u64,
    /// Number of standstills before its goal; absent if 0.
    #[serde(default, skip_serializing_if = "is_zero_count")]
    pub standstills: u32,
    /// Share of the verdicts "escape possible" on this evader; absent unless a referee judged it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub escape_possible_fraction: Option<f64>,
    /// Time from which on it had no guaranteed escape (s); absent if it escaped or had one at the end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub escape_impossible_from_s: Option<f64>,
    /// Outcome of its waypoints; absent unless its planner visits waypoints.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub waypoints: Option<WaypointOutcome>,
}

impl RobotOutcome {
    /// Returns the role of its team.
    pub fn role(&self) -> &str {
        match (&*self.role, &*self.team) {
            ("", "police") => "pursuer",
            ("", team) => team,
            (role, _) => role,
        }
    }
}

/// Outcome of the waypoints of a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WaypointOutcome {
    /// Number of waypoints reached.
    pub reached: u64,
    /// Number of waypoints left out because they are inside an obstacle that the robot knows.
    pub inside_obstacle: u64,
    /// Number of waypoints left out because they were not reached in time.
    pub timed_out: u64,
    /// Number of waypoints left out because no path leads to them.
    pub unreachable: u64,
    /// Number of waypoints left out because the robot did not get on; 0 in results of versions without it.
    #[serde(default)]
    pub stuck: u64,
    /// Number of those left out that belong to the route, which must be visited.
    #[serde(default)]
    pub route_left_out: u64,
    /// Maximum distance of the robot's centre from a waypoint that counts as reached (m).
    pub farthest_m: f64,
    /// Number of laps, from the first waypoint of the route to the last; absent without a route.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub laps: Option<u32>,
    /// Maximum duration of a lap (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longest_lap_s: Option<f64>,
    /// Time limit of a lap (s); absent without a route.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lap_limit_s: Option<f64>,
    /// Figures of the planned laps, through all waypoints including inserted ones; absent without a lap.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub planned: Option<LapFigures>,
    /// Figures of the driven laps; absent without a lap.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub driven: Option<LapFigures>,
}

impl WaypointOutcome {
    /// Returns the number of waypoints left out, for any reason.
    pub fn left_out(&self) -> u64 {
        self.inside_obstacle + self.timed_out + self.unreachable + self.stuck
    }
}

/// Figures of laps: means over the laps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LapFigures {
    /// Length (m).
    pub length_m: f64,
    /// Mean distance from a robot that follows the route exactly, at equal times (MAE) (m): driven laps by the
    /// time that they took, planned ones in the time of the patrol.
    pub mae_m: f64,
    /// Number of changes of direction in a lap.
    pub turns: f64,
    /// Mean change of direction (MAA), in [0, π] (rad).
    pub maa: f64,
    /// Mean change of direction, each folded to an acute angle, in [0, π/2] (rad).
    pub maa_fold: f64,
}

/// Coverage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CoverageOutcome {
    /// Visited share of the free area, 0 to 1.
    pub fraction: f64,
    /// Visited share of the coverable area, 0 to 1.
    pub coverable_fraction: f64,
    /// Free area (m²).
    pub free_m2: f64,
    /// Visited area (m²).
    pub visited_m2: f64,
    /// Mean time since the last visit over the coverable area (s).
    pub mean_idleness_s: f64,
    /// Maximum time since the last visit over the coverable area (s).
    pub worst_idleness_s: f64,
    /// Coefficient of variation of the visits per coverable cell.
    pub unevenness: f64,
    /// Total path length of the counted robots (m).
    pub way_m: f64,
    /// Coverage at a path length of 250, 500, 1000 and 2000 m, as far as reached.
    pub by_way: Vec<CoverageByWay>,
}

/// Coverage at a path length.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CoverageByWay {
    /// Path length (m).
    pub way_m: f64,
    /// Visited share of the coverable area, 0 to 1; interpolated linearly between reports.
    pub coverable_fraction: f64,
}

/// Idleness of a contour or of the nodes of a graph, the time since the last visit of its places: from the time at which each had been visited
/// twice ([`metrics::idleness`]); the figures are absent before.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PatrolOutcome {
    /// Names of the robots that patrol it.
    pub robots: Vec<String>,
    /// Mean over places and time (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean_idleness_s: Option<f64>,
    /// Maximum (s): the refresh time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst_idleness_s: Option<f64>,
    /// Standard deviation over places and time (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub std_idleness_s: Option<f64>,
    /// Mean over places of the mean time from one arrival of a robot to the next (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean_interval_s: Option<f64>,
    /// Minimum distance of two of the robots along the contour (m); absent for one that is alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nearest_m: Option<f64>,
    /// The nodes of a graph; none of a contour.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub nodes: Vec<NodeOutcome>,
}

/// Visits of a node of a patrolled graph.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NodeOutcome {
    /// Position (m).
    pub x: f64,
    /// Position (m).
    pub y: f64,
    /// Number of arrivals of robots.
    pub visits: u32,
    /// Mean time from one arrival to the next, since every node has been visited twice (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean_interval_s: Option<f64>,
    /// Longest time without a robot since then (s).
    pub worst_idleness_s: f64,
    /// Time since the last visit at the end (s).
    pub idleness_s: f64,
}

/// An attack on a place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AttackOutcome {
    /// Name of the process.
    pub attacker: String,
    /// Method by which place and time were chosen, of `AttackHeader::METHODS`.
    pub method: String,
    /// x coordinate of the place (m).
    pub x: f64,
    /// y coordinate of the place (m).
    pub y: f64,
    /// Time at which it began (s).
    pub begin_s: f64,
    /// Duration (s).
    pub duration_s: f64,
    /// Distance at which a guard detects it (m).
    pub distance_m: f64,
    /// Range at which a guard with a line of sight detects it (m); 0 for guards that do not see.
    pub sight_m: f64,
    /// `detected`, `undetected`, or `open` if the run ended before the attack.
    pub outcome: String,
    /// Time at which a guard detected it (s); absent without a detection.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detected_s: Option<f64>,
}

/// Attacks of one adversary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AttackTotals {
    /// Name of the process.
    pub attacker: String,
    /// Name of the method.
    pub method: String,
    /// Attacks that were judged: not those that the run did not see the end of.
    pub attacks: u32,
    /// Those that were detected.
    pub detected: u32,
}

impl AttackTotals {
    /// Returns the totals of all adversaries, by process and method.
    pub fn from_outcomes(attacks: &[AttackOutcome]) -> Vec<Self> {
        let mut totals: BTreeMap<(&str, &str), (u32, u32)> = BTreeMap::new();
        for attack in attacks.iter().filter(|attack| attack.outcome != "open") {
            let adversary = (&*attack.attacker, &*attack.method);
            let (judged, detected) = totals.entry(adversary).or_default();
            *judged += 1;
            *detected += u32::from(attack.detected_s.is_some());
        }
        let total = |((attacker, method), (attacks, detected)): ((&str, &str), _)| Self {
            attacker: attacker.to_owned(),
            method: method.to_owned(),
            attacks,
            detected,
        };
        totals.into_iter().map(total).collect()
    }
}

/// Accuracy of one method for one robot and one horizon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PredictionOutcome {
    /// Index of the observer's process.
    pub observer: u32,
    /// Name of the robot.
    pub robot: String,
    /// Name of the method, of `Prediction::METHODS`.
    pub method: String,
    /// Prediction horizon (s).
    pub horizon_s: f64,
    /// Number of evaluated predictions.
    pub predictions: u64,
    /// Number of times without a prediction.
    pub without: u64,
    /// Mean error (m); absent without a prediction, like the other errors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean_m: Option<f64>,
    /// Median error (m).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub median_m: Option<f64>,
    /// Root mean square error (m).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rms_m: Option<f64>,
    /// Number of goals that the method observed.
    pub goals_observed: u32,
    /// Time at which it first knew the key (s); absent if it never did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key_recovered_s: Option<f64>,
    /// Number of goals observed by then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key_recovered_after: Option<u32>,
}

/// Messages on a link.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LinkOutcome {
    /// Name of the topic.
    pub topic: String,
    /// Name of the sender.
    pub from: String,
    /// Name of the receiver.
    pub to: String,
    /// Number of messages sent.
    pub messages: u64,
    /// Number of those that never arrived.
    pub lost: u64,
}

/// Outcome of a process that failed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProcessOutcome {
    /// Name.
    pub name: String,
    /// Number of successful restarts.
    pub restarts: u32,
    /// Number of ticks without it.
    pub ticks_absent: u64,
    /// `true` if it was not restarted after the last failure.
    pub given_up: bool,
    /// Outages, in order.
    pub outages: Vec<Outage>,
}

/// An outage of a process.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Outage {
    /// First tick without the process.
    pub left_tick: u64,
    /// Simulated time of that tick (s).
    pub left_time_s: f64,
    /// Reason, such as `was ended by signal 9`.
    pub reason: String,
    /// First tick with the process again; absent if it did not return.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub back_tick: Option<u64>,
}

/// An event.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EventEntry {
    /// Time (s).
    pub time_s: f64,
    /// Kind, of `WorldEvent::NAMES`.
    pub kind: String,
    /// Name of the robot, if the event has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// Name of the obstacle, if the event is about one that has a name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub obstacle: Option<String>,
    /// Index of the other robot, id of the obstacle or index of the exit, depending on the kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub other: Option<u32>,
    /// x coordinate (m).
    pub x: f64,
    /// y coordinate (m).
    pub y: f64,
    /// Value, depending on the kind; 0 if it has none.
    pub value: f64,
}

impl EventEntry {
    /// Creates an event at this time (s) with the names of its robot and obstacle.
    pub fn new(time_s: f64, event: &WorldEvent, names: &EventNames) -> Self {
        let kind = WorldEvent::name_of(event.kind);
        let obstacle = (kind == "obstacle")
            .then(|| names.obstacles.get(&event.other))
            .flatten();
        Self {
            time_s,
            kind: kind.to_owned(),
            robot: names.robots.get(event.robot as usize).cloned(),
            obstacle: obstacle.cloned(),
            other: (event.other != WorldEvent::NONE).then_some(event.other),
            x: event.x,
            y: event.y,
            value: event.value,
        }
    }
}

/// Counts of a topic.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TopicCount {
    /// Number of messages in the log.
    pub messages: u64,
    /// Size of these messages, uncompressed (bytes).
    pub bytes: u64,
    /// Number of messages missing by sequence numbers.
    pub gaps: u64,
    /// Number of messages that failed the checks. The log contains them, except those with a number of
    /// elements that readers cannot decode.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub rejected: u64,
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde requires a reference"
)]
fn is_zero(n: &u64) -> bool {
    *n == 0
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde requires a reference"
)]
fn is_zero_count(n: &u32) -> bool {
    *n == 0
}

/// Converts simulated nanoseconds to seconds.
pub(super) fn seconds(ns: u64) -> f64 {
    ns as f64 / 1e9
}

/// Returns the name of the role with this team code of `RobotState`.
pub fn role_name(team: u8) -> &'static str {
    ["neutral", "pursuer", "evader"]
        .get(usize::from(team))
        .copied()
        .unwrap_or("unknown")
}

/// Returns the name of a status code of `RobotState`.
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
