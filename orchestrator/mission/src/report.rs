//! The report of a completed run.

use serde_json::{Value as Json, json};
use viewer::LiveTotals;

use recorder::Summary;
use scenario::spec::Mode;
use scenario::{ResolvedScenario, ScenarioRemark};

/// Result of a run.
#[derive(Debug, Clone)]
pub struct MissionReport {
    /// Summary of the log.
    pub summary: Summary,
    /// Real time from the first tick to the last one (s).
    pub wall_time_s: f64,
    /// Real time from the call to the first tick (s).
    pub start_up_s: f64,
    /// `true` if the caller ended the run.
    pub interrupted: bool,
    /// `true` if a process failed and the run continued.
    pub has_failures: bool,
    /// Totals of the live viewers, if the run served any.
    pub live: Option<LiveTotals>,
}

impl MissionReport {
    /// Returns the report as the JSON object of `protean run --json`.
    pub fn json(&self, scenario: &ResolvedScenario, remarks: &[ScenarioRemark]) -> Json {
        let s = &self.summary;
        let mut json = json!({
            "scenario": scenario.name,
            "seed": scenario.run.seed,
            "digest": s.digest,
            "ticks": s.ticks,
            "sim_time_s": s.sim_time_s,
            "wall_time_s": self.wall_time_s,
            "start_up_s": self.start_up_s,
            "real_time_factor": self.real_time_factor(),
            "interrupted": self.interrupted,
            "robots": s.robots,
            "events": s.events,
            "events_omitted": s.events_omitted,
            "simulated_messages": s.message_counts().simulated,
            "topics": s.topics,
            "log": s.log,
            "log_bytes": s.log_bytes,
        });
        if let Some(coverage) = &s.coverage {
            json["coverage"] = json!(coverage);
        }
        if !s.patrols.is_empty() {
            json["patrols"] = json!(s.patrols);
        }
        if !s.attacks.is_empty() {
            json["attacks"] = json!(s.attacks);
        }
        if !remarks.is_empty() {
            json["remarks"] = json!(remarks);
        }
        if !s.processes.is_empty() {
            json["processes"] = json!(s.processes);
        }
        if !s.links.is_empty() {
            json["links"] = json!(s.links);
        }
        if let Some(predictions) = &s.predictions {
            json["predictions"] = json!(predictions);
        }
        for (key, value) in [
            ("escape_possible_fraction", s.escape_possible_fraction),
            ("escape_impossible_from_s", s.escape_impossible_from_s),
        ] {
            if let Some(value) = value {
                json[key] = value.into();
            }
        }
        // A run in one process has none.
        if !s.latency_us.is_empty() {
            json["latency_us"] = json!(s.latency_us);
        }
        json
    }

    /// Returns the simulated time per real time, from the first tick to the last one.
    pub fn real_time_factor(&self) -> f64 {
        self.summary.sim_time_s / self.wall_time_s.max(1e-9)
    }
}

/// Returns the name of a mode in logs.
pub fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::LockStep => "lock_step",
        Mode::RealTime => "real_time",
    }
}
