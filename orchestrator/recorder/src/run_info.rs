//! Description of a run for the recorder.

use std::collections::BTreeMap;

use runtime::link::Link;

use super::event_names::EventNames;

/// A process of the run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProcessInfo {
    /// Index: the `source` of its stamps.
    pub index: u32,
    /// Name in the run.
    pub name: String,
    /// Kind; latencies are grouped by it.
    pub kind: String,
    /// `true` if its commands wait for the beliefs of their tick.
    pub reads_beliefs: bool,
}

/// A robot of the run; its position in the list is its index.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotInfo {
    /// Its name.
    pub name: String,
    /// Name of its team.
    pub team: String,
    /// Radius (m), > 0.
    pub radius: f64,
    /// `true` if it may visit waypoints; then its path is kept for the summary.
    pub visits_waypoints: bool,
    /// Time limit of its laps (s); `None` without laps.
    pub lap_limit_s: Option<f64>,
}

/// Description of the recorded run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RunInfo {
    /// All sending processes, including the orchestrator. Messages of others are logged and counted as
    /// rejected.
    pub processes: Vec<ProcessInfo>,
    /// All robots.
    pub robots: Vec<RobotInfo>,
    /// Names of the obstacles that have one, by id.
    pub obstacles: BTreeMap<u32, String>,
    /// Simulated time between two ticks (ns), > 0.
    pub tick_period_ns: u64,
    /// All links.
    pub links: Vec<Link>,
    /// Seed of the run, from which losses are drawn.
    pub seed: u64,
}

impl RunInfo {
    /// Returns the names for events.
    pub fn event_names(&self) -> EventNames {
        EventNames {
            robots: self.robots.iter().map(|robot| robot.name.clone()).collect(),
            obstacles: self.obstacles.clone(),
        }
    }
}
