//! What the recorder is told about a run.

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

/// The run that is recorded.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RunInfo {
    /// All processes that send, the orchestrator included. Messages of others are logged but
    /// counted as rejected.
    pub processes: Vec<ProcessInfo>,
    /// All robots.
    pub robots: Vec<RobotInfo>,
    /// Simulated time between two ticks (ns), > 0.
    pub tick_period_ns: u64,
}
