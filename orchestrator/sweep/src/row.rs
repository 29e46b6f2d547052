//! The result of one mission.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::columns::{Part, ResultColumn, ResultTable, columns};
use super::kind::Kind;
use mission::MissionReport;
use recorder::{
    AttackTotals, CoverageOutcome, PatrolOutcome, PredictionOutcome, RobotOutcome, Summary,
};

/// Name of the files of the table with one row per mission.
pub const RESULTS: &str = "results";

/// A row of results. It does not depend on the machine or on the engine.
pub trait Record: Clone + PartialEq + Serialize + DeserializeOwned + Send + 'static {
    /// Kind of the missions.
    const KIND: Kind;

    /// The tables of results: of the rows themselves, then of parts of them.
    const TABLES: &'static [ResultTable<Self>];

    /// Returns the row of a mission that failed, with the reason.
    fn failed(error: String) -> Self;

    /// Returns `true` if the mission failed, and may be executed again.
    fn is_failed(&self) -> bool;

    /// Returns the reason of the failure; empty without one.
    fn error(&self) -> &str;
}

/// Outcome of a mission.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Every evader was caught or escaped, every goal was reached.
    Ended,
    /// The time limit ended it for at least one robot.
    TimeLimit,
    /// The mission failed; `error` contains the reason.
    #[default]
    Failed,
}

impl Outcome {
    /// Name in the results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ended => "ended",
            Self::TimeLimit => "time_limit",
            Self::Failed => "failed",
        }
    }
}

/// The result of one mission. It does not depend on the machine or on the engine.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Outcome.
    pub outcome: Outcome,
    /// Robots that are evaders.
    pub evaders: u32,
    /// Evaders that reached an exit.
    pub escaped: u32,
    /// Evaders that were caught.
    pub caught: u32,
    /// Evaders that were still in the game at the time limit.
    pub held_out: u32,
    /// Simulated length (s).
    pub sim_time_s: f64,
    /// Simulated time of the first capture (s).
    pub first_capture_s: Option<f64>,
    /// Simulated time of the first escape (s).
    pub first_escape_s: Option<f64>,
    /// Contact episodes of all robots.
    pub contacts: u32,
    /// Distance driven by all evaders (m).
    pub evader_distance_m: f64,
    /// Distance driven by the time in the game (m/s).
    pub evader_mean_speed: Option<f64>,
    /// Ticks of the world.
    pub ticks: u64,
    /// Part of the game in which an escape was possible, 0 to 1; needs a referee.
    pub escape_possible_fraction: Option<f64>,
    /// Simulated time from which no escape was possible (s); needs a referee.
    pub escape_impossible_from_s: Option<f64>,
    /// The area visited, with `[rules.coverage]`.
    pub coverage: Option<CoverageOutcome>,
    /// Idleness of the contours that are patrolled.
    #[serde(default)]
    pub patrols: Vec<PatrolOutcome>,
    /// Attacks by adversary.
    #[serde(default)]
    pub attacks: Vec<AttackTotals>,
    /// Errors of the observers' predictions.
    pub predictions: Vec<PredictionOutcome>,
    /// Digest of the run.
    pub digest: String,
    /// Reason of the failure.
    pub error: String,
    /// Outcomes of the robots.
    pub robots: Vec<RobotOutcome>,
}

impl Row {
    /// Returns the row of a mission that ended.
    pub fn from_report(report: &MissionReport) -> Self {
        let summary = &report.summary;
        let lost: u64 = summary.topics.values().map(|t| t.gaps).sum();
        if lost > 0 {
            return Self::failed(format!("{lost} messages were lost"));
        }
        Self::of_summary(summary)
    }

    fn of_summary(summary: &Summary) -> Self {
        let evaders = || summary.robots.iter().filter(|r| r.role() == "evader");
        let count = |outcome: &str| evaders().filter(|r| r.outcome == outcome).count() as u32;
        let first = |outcome: &str| {
            let times = evaders().filter(|r| r.outcome == outcome).map(|r| r.time_s);
            times.min_by(f64::total_cmp)
        };
        let timed_out = summary.robots.iter().any(|r| r.outcome == "timed_out");
        // A sum of nothing is -0 in Rust.
        let distance = evaders().fold(0.0, |sum, r| sum + r.distance_m);
        let time: f64 = evaders().map(|r| r.time_s).sum();
        Self {
            outcome: if timed_out {
                Outcome::TimeLimit
            } else {
                Outcome::Ended
            },
            evaders: evaders().count() as u32,
            escaped: count("escaped"),
            caught: count("caught"),
            held_out: count("timed_out"),
            sim_time_s: summary.sim_time_s,
            first_capture_s: first("caught"),
            first_escape_s: first("escaped"),
            contacts: summary.robots.iter().map(|r| r.contacts).sum(),
            evader_distance_m: distance,
            evader_mean_speed: (time > 0.0).then(|| distance / time),
            ticks: summary.ticks,
            escape_possible_fraction: summary.escape_possible_fraction,
            escape_impossible_from_s: summary.escape_impossible_from_s,
            coverage: summary.coverage.clone(),
            patrols: summary.patrols.clone(),
            attacks: AttackTotals::from_outcomes(&summary.attacks),
            predictions: summary.predictions.clone().unwrap_or_default(),
            digest: summary.digest.clone(),
            error: String::new(),
            robots: summary.robots.clone(),
        }
    }

    /// Returns the row of a mission that failed.
    pub fn failed(error: impl Into<String>) -> Self {
        Self {
            error: error.into(),
            ..Self::default()
        }
    }

    /// Returns `true` if the mission failed.
    pub fn is_failed(&self) -> bool {
        self.outcome == Outcome::Failed
    }
}

impl Record for Row {
    const KIND: Kind = Kind::Missions;

    const TABLES: &'static [ResultTable<Self>] = &[
        ResultTable::from_part::<Self>(),
        ResultTable::from_part::<RobotOutcome>(),
        ResultTable::from_part::<PredictionOutcome>(),
        ResultTable::from_part::<AttackTotals>(),
    ];

    fn failed(error: String) -> Self {
        Self::failed(error)
    }

    fn is_failed(&self) -> bool {
        Self::is_failed(self)
    }

    fn error(&self) -> &str {
        &self.error
    }
}

impl Part<Self> for Row {
    const TABLE: &'static str = RESULTS;
    const REFERENCE: [&'static str; 2] = ["Missions", "one row per mission"];

    const COLUMNS: &'static [ResultColumn<Self>] = columns! { r;
        Text "outcome", "`ended`; `time_limit` if it ended the game of a robot; `failed`." => r.outcome.name();
        Int "evaders", "Evaders." => known(r, r.evaders);
        Int "escaped", "Evaders that escaped." => known(r, r.escaped);
        Int "caught", "Evaders that were caught." => known(r, r.caught);
        Int "held_out", "Evaders that were neither caught nor had escaped at the time limit." => known(r, r.held_out);
        F64 "sim_time_s", "Simulated duration (s)." => known(r, r.sim_time_s);
        F64 "first_capture_s", "Simulated time of the first capture (s); empty without one." => r.first_capture_s;
        F64 "first_escape_s", "Simulated time of the first escape (s); empty without one." => r.first_escape_s;
        Int "contacts", "Contact episodes of all robots." => known(r, r.contacts);
        F64 "evader_distance_m", "Distance of all evaders (m)." => known(r, r.evader_distance_m);
        F64 "evader_mean_speed", "Distance of all evaders by their time in the game (m/s)." => r.evader_mean_speed;
        Int "ticks", "Ticks of the simulator." => known(r, r.ticks);
        F64 "escape_possible_fraction",
            "Part of the game in which an escape was possible, 0 to 1; empty without a `referee`."
            => r.escape_possible_fraction;
        F64 "escape_impossible_from_s",
            "Simulated time from which no escape was possible (s); empty without a `referee`."
            => r.escape_impossible_from_s;
        F64 "coverage_fraction", "Visited share of the free area; empty without `[rules.coverage]`."
            => r.coverage.as_ref().map(|c| c.fraction);
        F64 "coverable_fraction", "Visited share of the reachable area; empty without `[rules.coverage]`."
            => r.coverage.as_ref().map(|c| c.coverable_fraction);
        F64 "way_m", "Distance of the robots that count for the coverage (m); empty without `[rules.coverage]`."
            => r.coverage.as_ref().map(|c| c.way_m);
        F64 "idleness_mean_s",
            "Mean time since the last visit of a place of a patrolled contour or graph (s), of the one where it is \
             longest; empty without a patrol."
            => patrols(r, |p| p.mean_idleness_s, f64::max);
        F64 "idleness_worst_s", "Maximum of that time (s), the refresh time; empty without a patrol."
            => patrols(r, |p| p.worst_idleness_s, f64::max);
        F64 "idleness_std_s",
            "Standard deviation of that time (s), of the contour or graph where it is largest; empty without a patrol."
            => patrols(r, |p| p.std_idleness_s, f64::max);
        F64 "idleness_interval_s",
            "Mean time from one arrival of a robot to the next (s), mean over places: the average graph idleness of \
             `patrolling_sim`; empty without a patrol."
            => patrols(r, |p| p.mean_interval_s, f64::max);
        F64 "patrol_nearest_m",
            "Minimum distance of two robots of a team along their contour (m); empty without a team on patrol."
            => patrols(r, |p| p.nearest_m, f64::min);
        Int "attacks", "Attacks that ended in the run, of all adversaries; empty without one."
            => attacks(r, |a| a.attacks);
        Int "attacks_detected", "Attacks that guards detected; empty without an attack."
            => attacks(r, |a| a.detected);
        F64 "detection_share", "Attacks that guards detected, of all, 0 to 1; empty without an attack."
            => detection_share(r);
        Text "digest", "Digest of the run, as `protean run` prints it." => r.digest.as_str();
        Text "error", "Reason of a failure." => r.error.as_str();
    };

    fn rows(row: &Self) -> &[Self] {
        std::slice::from_ref(row)
    }
}

/// Returns the sum over all adversaries; `None` without an attack.
fn attacks(row: &Row, count: fn(&AttackTotals) -> u32) -> Option<u64> {
    let counts = row.attacks.iter().map(count).map(u64::from);
    counts.reduce(|sum, count| sum + count)
}

/// Returns the share of all attacks that guards detected, 0 to 1; `None` without an attack.
fn detection_share(row: &Row) -> Option<f64> {
    let detected = attacks(row, |a| a.detected)?;
    Some(detected as f64 / attacks(row, |a| a.attacks)? as f64)
}

/// Returns a value of all contours.
fn patrols(
    row: &Row,
    value: fn(&PatrolOutcome) -> Option<f64>,
    of_two: fn(f64, f64) -> f64,
) -> Option<f64> {
    row.patrols.iter().filter_map(value).reduce(of_two)
}

/// Returns a value of a mission that did not fail.
fn known<T>(row: &Row, value: T) -> Option<T> {
    (!row.is_failed()).then_some(value)
}
