//! What a run amounted to.

use std::collections::BTreeMap;
use std::path::PathBuf;

use ipc_types::messages::observer::Prediction;
use ipc_types::messages::process::ProcessEvent;
use ipc_types::messages::referee::Verdict;
use ipc_types::messages::robot::WaypointEnd;
use ipc_types::messages::world::{CoverageState, RobotState, WorldEvent, WorldHeader};
use nalgebra::Point2;
use serde::{Deserialize, Serialize};

use super::judged::Judged;
use super::options::ProcessInfo;
use super::options::RobotInfo;
use super::outages::{Outages, ProcessOutcome};
use super::predicted::{Predicted, PredictionOutcome};
use super::visits::{Visits, WaypointOutcome};
use crate::statistics::Percentiles;

/// Most events that a summary lists; the log has all.
const MAX_EVENTS: usize = 100_000;

/// What a run amounted to, as `protean run --json` prints it (design §10).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Fingerprint of the simulated history, 64 hexadecimal digits.
    pub digest: String,
    /// Last tick of the world.
    pub ticks: u64,
    /// Simulated time of that tick [s].
    pub sim_time_s: f64,
    /// What became of every robot, by its index.
    pub robots: Vec<RobotOutcome>,
    /// Share of the verdicts on all evaders that said "escape possible"; absent unless a referee
    /// ran.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub escape_possible_fraction: Option<f64>,
    /// Time from which on no evader could be sure of an escape any more [s]; absent unless a referee
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
    /// Latencies by name [µs].
    pub latency_us: BTreeMap<String, Percentiles>,
    /// The log; empty if there is none because nothing happened.
    pub log: PathBuf,
    /// Its size [bytes].
    pub log_bytes: u64,
}

/// What became of a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RobotOutcome {
    /// Its name.
    pub name: String,
    /// `neutral`, `police` or `evader`.
    pub team: String,
    /// `active`, `caught`, `escaped`, `timed_out`, `goal_reached` or `disabled`.
    pub outcome: String,
    /// When that was decided, or the end of the run for an active one [s].
    pub time_s: f64,
    /// Path length driven [m].
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
    /// Time from which on it could not be sure of an escape any more [s]; absent if it escaped, or
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
    /// Free area [m²].
    pub free_m2: f64,
    /// Visited area [m²].
    pub visited_m2: f64,
    /// Mean time since the last visit over the coverable area [s].
    pub mean_idleness_s: f64,
    /// Longest that any coverable place has waited for a visit [s].
    pub worst_idleness_s: f64,
    /// Standard deviation of the visits of a coverable cell, divided by their mean.
    pub unevenness: f64,
    /// Way driven by the robots that count, together [m].
    pub way_m: f64,
    /// What part of the area that the robots can visit had been visited when that way had become
    /// 250, 500, 1000 and 2000 m; as far as the run came.
    pub by_way: Vec<CoverageByWay>,
}

/// The area visited along a way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CoverageByWay {
    /// The way [m].
    pub way_m: f64,
    /// Visited part of the area that can be visited, 0…1; between two reports, the straight line.
    pub coverable_fraction: f64,
}

/// Ways at which coverage is noted [m].
const WAYS: [f64; 4] = [250.0, 500.0, 1000.0, 2000.0];

/// One event.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EventEntry {
    /// When [s].
    pub time_s: f64,
    /// What: [`WorldEvent::NAMES`].
    pub kind: String,
    /// Name of the robot it happened to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// The other robot's index, the obstacle's id or the exit's index, by kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub other: Option<u32>,
    /// Where, x [m].
    pub x: f64,
    /// Where, y [m].
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

/// Collects the outcome of a run from its states and events.
#[derive(Debug)]
pub(super) struct Outcome {
    names: Vec<String>,
    tick_period_ns: u64,
    tick: u64,
    robots: Vec<RobotState>,
    /// When each robot's status changed last [s].
    decided: Vec<f64>,
    /// How often each robot was stopped for want of a command.
    stops: Vec<u32>,
    /// How many ticks each robot stood stopped for want of a command.
    stopped: Vec<u64>,
    outages: Outages,
    events: Vec<EventEntry>,
    omitted: u64,
    coverage: Option<CoverageOutcome>,
    /// What a referee said of each robot.
    judged: Vec<Judged>,
    /// What became of each robot's waypoints.
    visits: Vec<Visits>,
    predicted: Predicted,
}

impl Outcome {
    pub(super) fn new(
        robots: &[RobotInfo],
        processes: &[ProcessInfo],
        tick_period_ns: u64,
    ) -> Self {
        Self {
            names: robots.iter().map(|r| r.name.clone()).collect(),
            tick_period_ns,
            tick: 0,
            robots: vec![RobotState::default(); robots.len()],
            decided: vec![0.0; robots.len()],
            stops: vec![0; robots.len()],
            stopped: vec![0; robots.len()],
            outages: Outages::new(processes, tick_period_ns),
            events: Vec::new(),
            omitted: 0,
            coverage: None,
            judged: vec![Judged::default(); robots.len()],
            visits: robots
                .iter()
                .map(|robot| Visits::new(robot.visits_waypoints))
                .collect(),
            predicted: Predicted::default(),
        }
    }

    pub(super) fn prediction(&mut self, observer: u32, time_s: f64, prediction: &Prediction) {
        self.predicted.add(observer, time_s, prediction);
    }

    pub(super) fn process_event(&mut self, event: &ProcessEvent) {
        self.outages.add(event);
    }

    pub(super) fn verdict(&mut self, time_s: f64, verdict: &Verdict) {
        if let Some(judged) = self.judged.get_mut(verdict.robot as usize) {
            judged.add(time_s, verdict.escape_possible != 0);
        }
    }

    pub(super) fn waypoint(&mut self, end: &WaypointEnd) {
        if let Some(visits) = self.visits.get_mut(end.robot as usize) {
            visits.add(end);
        }
    }

    pub(super) fn state(&mut self, header: &WorldHeader, robots: &[RobotState]) {
        self.tick = header.stamp.tick;
        let now = self.time_s();
        for state in robots {
            let robot = state.robot as usize;
            let (Some(known), Some(decided), Some(stops), Some(visits)) = (
                self.robots.get_mut(robot),
                self.decided.get_mut(robot),
                self.stops.get_mut(robot),
                self.visits.get_mut(robot),
            ) else {
                continue;
            };
            visits.state(now, Point2::new(state.x, state.y));
            *stops += u32::from(state.fail_safe != 0 && known.fail_safe == 0);
            if let Some(stopped) = self.stopped.get_mut(robot) {
                *stopped += u64::from(state.fail_safe != 0);
            }
            if state.status == 0 || known.status != state.status {
                *decided = now;
            }
            *known = *state;
        }
    }

    pub(super) fn event(&mut self, time_s: f64, event: &WorldEvent) {
        if self.events.len() >= MAX_EVENTS {
            self.omitted += 1;
            return;
        }
        self.events.push(EventEntry {
            time_s,
            kind: WorldEvent::name_of(event.kind).to_owned(),
            robot: self.names.get(event.robot as usize).cloned(),
            other: (event.other != WorldEvent::NONE).then_some(event.other),
            x: event.x,
            y: event.y,
            value: event.value,
        });
    }

    pub(super) fn coverage(&mut self, report: &CoverageState) {
        let before = self.coverage.take();
        let (mut by_way, from) = match before {
            Some(before) => (before.by_way, (before.way_m, before.coverable_fraction)),
            None => (Vec::new(), (0.0, 0.0)),
        };
        for way_m in WAYS {
            if from.0 < way_m && way_m <= report.way {
                let part = (way_m - from.0) / (report.way - from.0);
                let coverable_fraction = from.1 + part * (report.coverable_fraction - from.1);
                by_way.push(CoverageByWay {
                    way_m,
                    coverable_fraction,
                });
            }
        }
        self.coverage = Some(CoverageOutcome {
            fraction: report.fraction,
            coverable_fraction: report.coverable_fraction,
            free_m2: f64::from(report.free) * report.cell_area,
            visited_m2: f64::from(report.visited) * report.cell_area,
            mean_idleness_s: report.mean_idleness,
            worst_idleness_s: report.worst_idleness,
            unevenness: report.unevenness,
            way_m: report.way,
            by_way,
        });
    }

    fn time_s(&self) -> f64 {
        seconds(self.tick.saturating_mul(self.tick_period_ns))
    }

    pub(super) fn finish(
        self,
        digest: String,
        topics: BTreeMap<String, TopicCount>,
        latency_us: BTreeMap<String, Percentiles>,
        log: PathBuf,
        log_bytes: u64,
    ) -> Summary {
        let sim_time_s = self.time_s();
        let predictions = self.predicted.finish(&self.names);
        let robots = self
            .names
            .into_iter()
            .zip(&self.robots)
            .zip(&self.decided)
            .zip(self.stops.iter().zip(&self.stopped))
            .zip(&self.judged)
            .zip(self.visits)
            .map(
                |(((((name, state), &time_s), (&stops, &stopped)), judged), visits)| RobotOutcome {
                    name,
                    team: team_name(state.team).to_owned(),
                    outcome: status_name(state.status).to_owned(),
                    time_s,
                    distance_m: state.distance,
                    contacts: state.contacts,
                    fail_safe_stops: stops,
                    fail_safe_ticks: stopped,
                    escape_possible_fraction: judged.fraction(),
                    escape_impossible_from_s: judged.impossible_from(state),
                    waypoints: visits.finish(),
                },
            )
            .collect();
        let all = self.judged.iter().fold(Judged::default(), Judged::and);
        // The last of them decides; one that could escape, or did, leaves none.
        let impossible_from = self
            .judged
            .iter()
            .zip(&self.robots)
            .filter(|(judged, _)| judged.verdicts > 0)
            .map(|(judged, state)| judged.impossible_from(state))
            .try_fold(f64::NEG_INFINITY, |last, from| Some(last.max(from?)));
        Summary {
            digest,
            ticks: self.tick,
            sim_time_s,
            robots,
            escape_possible_fraction: all.fraction(),
            escape_impossible_from_s: impossible_from.filter(|from| from.is_finite()),
            events: self.events,
            events_omitted: self.omitted,
            coverage: self.coverage,
            predictions,
            processes: self.outages.finish(self.tick),
            topics,
            latency_us,
            log,
            log_bytes,
        }
    }
}

/// Simulated nanoseconds as seconds.
pub(super) fn seconds(ns: u64) -> f64 {
    ns as f64 / 1e9
}

/// Name of a team's code in [`RobotState`].
pub fn team_name(team: u8) -> &'static str {
    ["neutral", "police", "evader"]
        .get(usize::from(team))
        .copied()
        .unwrap_or("unknown")
}

/// Name of a status code in [`RobotState`].
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
