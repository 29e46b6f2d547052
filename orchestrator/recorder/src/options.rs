//! What the recorder is told about a run.

use std::path::PathBuf;

use ipc_types::messages::world::ObstacleEvent;
use mcap_log::{LogOptions, Manifest};

use super::eyes::EyeInfo;

/// A process of the run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProcessInfo {
    /// Its index: the `source` of its stamps.
    pub index: u32,
    /// Its name in the run.
    pub name: String,
    /// Its kind, by which latencies are grouped.
    pub kind: String,
    /// Whether its commands wait for the beliefs of their tick.
    pub reads_beliefs: bool,
}

/// A robot of the run; its place in the list is its index.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotInfo {
    /// Its name.
    pub name: String,
    /// Its radius (m), > 0.
    pub radius: f64,
    /// Whether it may visit waypoints: then its way is kept for what the run amounts to.
    pub visits_waypoints: bool,
}

/// What viewers get to see.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewerOptions {
    /// Pictures per simulated second; 0 for no viewer topics at all.
    pub rate_hz: f64,
    /// How long a robot's trail stays visible (simulated s); 0 for none.
    pub trail_s: f64,
}

impl Default for ViewerOptions {
    fn default() -> Self {
        Self {
            rate_hz: 10.0,
            trail_s: 5.0,
        }
    }
}

/// What is recorded, how and where.
#[derive(Debug, Clone, PartialEq)]
pub struct RecorderOptions {
    /// The file.
    pub path: PathBuf,
    /// How the file is written.
    pub log: LogOptions,
    /// What stands at its head.
    pub manifest: Manifest,
    /// All processes that send, the orchestrator included. Messages of others are logged but
    /// counted as rejected.
    pub processes: Vec<ProcessInfo>,
    /// All robots.
    pub robots: Vec<RobotInfo>,
    /// Simulated time between two ticks (ns), > 0.
    pub tick_period_ns: u64,
    /// What viewers get to see.
    pub viewer: ViewerOptions,
    /// Obstacles that stand from the beginning, for viewers.
    pub obstacles: Vec<ObstacleEvent>,
    /// Who looks: what is seen from there is drawn for viewers.
    pub eyes: Vec<EyeInfo>,
}
