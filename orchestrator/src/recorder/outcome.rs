//! What the messages of a run say of how it went.

use std::collections::BTreeMap;
use std::path::PathBuf;

use ipc_types::cdr::view;
use ipc_types::messages::referee::Verdict;
use ipc_types::messages::robot::WaypointEnd;
use ipc_types::messages::world::{CoverageState, RobotState, WorldEvent, WorldHeader};
use ipc_types::topics::{
    Coverage, Predictions, ProcessEvents, TopicId, Verdicts, Waypoints, WorldEvents, WorldState,
};
use nalgebra::Point2;
use statistics::Percentiles;

use super::judged::Judged;
use super::message::Message;
use super::options::{ProcessInfo, RobotInfo};
use super::outages::Outages;
use super::predicted::Predicted;
use super::summary::{
    CoverageByWay, CoverageOutcome, EventEntry, RobotOutcome, Summary, TopicCount, seconds,
    status_name, team_name,
};
use super::visits::Visits;

/// Most events that a summary lists; the log has all.
const MAX_EVENTS: usize = 100_000;

/// Ways at which coverage is noted [m].
const WAYS: [f64; 4] = [250.0, 500.0, 1000.0, 2000.0];

/// The outcome of a run so far.
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
    /// Of a run with these robots and processes, before its first tick.
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

    /// Whether messages of this topic say something of the outcome.
    pub(super) fn wants(topic: TopicId) -> bool {
        matches!(
            topic,
            TopicId::WorldState
                | TopicId::WorldEvents
                | TopicId::Coverage
                | TopicId::Verdicts
                | TopicId::Predictions
                | TopicId::Waypoints
                | TopicId::ProcessEvents
        )
    }

    /// Takes up the next message that passed the checks, in the order of the log.
    pub(super) fn message(&mut self, message: &Message<'_>) {
        let (bytes, time_s) = (message.bytes, seconds(message.time_ns));
        match message.topic {
            TopicId::WorldState => {
                if let Some((header, robots)) = view::<WorldState>(bytes) {
                    self.state(&header, robots);
                }
            }
            TopicId::WorldEvents => {
                if let Some((_, events)) = view::<WorldEvents>(bytes) {
                    events.for_each(|event| self.event(time_s, &event));
                }
            }
            TopicId::Coverage => {
                if let Some((_, reports)) = view::<Coverage>(bytes) {
                    reports.for_each(|report| self.coverage(&report));
                }
            }
            TopicId::Verdicts => {
                if let Some((_, verdicts)) = view::<Verdicts>(bytes) {
                    verdicts.for_each(|verdict| self.verdict(time_s, &verdict));
                }
            }
            TopicId::Predictions => {
                if let Some((_, predictions)) = view::<Predictions>(bytes) {
                    let observer = message.stamp.source;
                    predictions.for_each(|p| self.predicted.add(observer, time_s, &p));
                }
            }
            TopicId::Waypoints => {
                if let Some((_, ends)) = view::<Waypoints>(bytes) {
                    ends.for_each(|end| self.waypoint(&end));
                }
            }
            TopicId::ProcessEvents => {
                if let Some((_, events)) = view::<ProcessEvents>(bytes) {
                    events.for_each(|event| self.outages.add(&event));
                }
            }
            _ => {}
        }
    }

    pub(super) fn verdict(&mut self, time_s: f64, verdict: &Verdict) {
        if let Some(judged) = self.judged.get_mut(verdict.robot as usize) {
            judged.add(time_s, verdict.escape_possible != 0);
        }
    }

    fn waypoint(&mut self, end: &WaypointEnd) {
        if let Some(visits) = self.visits.get_mut(end.robot as usize) {
            visits.add(end);
        }
    }

    pub(super) fn state(&mut self, header: &WorldHeader, robots: impl Iterator<Item = RobotState>) {
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
            *known = state;
        }
    }

    fn event(&mut self, time_s: f64, event: &WorldEvent) {
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

    fn coverage(&mut self, report: &CoverageState) {
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

    /// What the run amounted to; there is no log of it yet.
    pub(super) fn finish(
        self,
        digest: String,
        topics: BTreeMap<String, TopicCount>,
        latency_us: BTreeMap<String, Percentiles>,
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
            log: PathBuf::new(),
            log_bytes: 0,
        }
    }
}
