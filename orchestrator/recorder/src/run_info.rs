//! Description of a run, for the recorder and in the log.

use std::collections::BTreeMap;

use ipc_types::event_names::EventNames;
use mcap_log::Origin;
use runtime::kind::{GraphSketch, TaskSketch};
use runtime::link::Link;
use serde::{Deserialize, Serialize};

use super::field_of_view::FieldOfView;

/// A process of the run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProcessInfo {
    /// Index: the `source` of its stamps.
    pub index: u32,
    /// Name in the run.
    pub name: String,
    /// Kind; latencies are grouped by it.
    pub kind: String,
    /// Indices of the processes whose messages of a tick it waits for, beside the simulator and the orchestrator.
    pub upstream: Vec<u32>,
}

/// A robot of the run; its position in the list is its index.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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

/// A contour or a graph, and the robots that patrol it with the same task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PatrolInfo {
    /// Indices of the robots.
    pub robots: Vec<u32>,
    /// Corners of the contour, in order (m); the first again at the end if it is closed.
    pub contour: Vec<[f64; 2]>,
    /// The graph, in place of a contour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub graph: Option<GraphSketch>,
}

/// The task of a robot, drawn in pictures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TaskInfo {
    /// Index of the robot.
    pub robot: u32,
    /// Geometry of the task.
    pub sketch: TaskSketch,
}

/// Description of a run. It is in the log, so that readers need neither the scenario nor the kinds of processes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
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
    /// Wall-clock time between two ticks (ns), > 0; `None` in lock-step.
    pub wall_period_ns: Option<u64>,
    /// Fields of view of the processes; none without a log.
    pub fields_of_view: Vec<FieldOfView>,
    /// Tasks with a geometry, in the order of the processes; none without a log.
    pub tasks: Vec<TaskInfo>,
    /// Contours that are patrolled.
    #[serde(default)]
    pub patrols: Vec<PatrolInfo>,
    /// All links.
    pub links: Vec<Link>,
    /// Seed of the run, from which losses are drawn.
    pub seed: u64,
}

impl RunInfo {
    /// Returns the description in a log; `None` if it is not in the log or cannot be read.
    pub fn from_log(origin: &Origin) -> Option<Self> {
        serde_json::from_slice(origin.run.as_deref()?).ok()
    }

    /// Returns the name of a process by its index.
    pub fn process_name(&self, index: u32) -> String {
        let process = self.processes.iter().find(|info| info.index == index);
        process.map_or_else(|| format!("process {index}"), |found| found.name.clone())
    }

    /// Returns the names for events.
    pub fn event_names(&self) -> EventNames {
        EventNames {
            robots: self.robots.iter().map(|robot| robot.name.clone()).collect(),
            obstacles: self.obstacles.clone(),
        }
    }
}
