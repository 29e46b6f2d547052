//! Laps of the zig-zag under many keys, as the paper computes them: without a robot.

use metrics::path::PathMetrics;
use plan::routes::patrol::Patrol;

/// Number of keys, drawn from the seeds 1, 2, ….
const KEYS: u64 = 60;
/// Number of laps: as many as the paper's figures show.
const LAPS: u32 = 12;

/// Failure to compute laps: a problem with a built-in scenario.
#[derive(Debug, thiserror::Error)]
#[error("cannot plan laps in the scenario `{scenario}`: {reason}")]
pub struct LapsError {
    scenario: &'static str,
    reason: String,
}

/// The laps of a case of the paper.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Laps {
    /// Speed along the contour (m/s).
    pub v: f64,
    /// Metrics under each key.
    pub metrics: Vec<PathMetrics>,
}

impl Laps {
    /// Computes laps of a built-in scenario, with these overrides of its mission.
    ///
    /// # Errors
    /// [`LapsError`].
    pub(super) fn of(scenario: &'static str, mission: &[&str]) -> Result<Self, LapsError> {
        let failed = |reason: &dyn std::fmt::Display| LapsError {
            scenario,
            reason: reason.to_string(),
        };
        let set = |key: &&str| format!("processes.patrol.params.mission.{key}");
        let mut overrides: Vec<String> = mission.iter().map(set).collect();
        overrides.push("processes.patrol.params.mission.preset=\"paper_fit\"".to_owned());
        let mut laps = Self {
            v: 0.0,
            metrics: Vec::new(),
        };
        for seed in 1..=KEYS {
            let resolved = kinds::load(scenario, &overrides, Some(seed)).map_err(|e| failed(&e))?;
            let patrol = Patrol::of(&resolved, None, None).map_err(|e| failed(&e))?;
            let planned = patrol.laps(LAPS).map_err(|e| failed(&e))?;
            laps.v = patrol.v();
            laps.metrics.extend(planned.metrics);
        }
        Ok(laps)
    }

    /// Returns a metric under each key.
    pub(super) fn values(&self, metric: fn(&PathMetrics) -> f64) -> Vec<f64> {
        self.metrics.iter().map(metric).collect()
    }
}
