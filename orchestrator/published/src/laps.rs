//! Laps of a zig-zag as the cat-map patrol paper computes them: without a robot.

use core::error::Error;

use metrics::path::PathMetrics;
use plan::routes::patrol::Patrol;

use crate::ScenarioError;

/// Returns the speed along the contour (m/s) and the metrics of the first laps of the patrol of a built-in scenario
/// under the key of a seed.
///
/// # Errors
/// The scenario has no such patrol.
pub fn of_seed(
    scenario: &str,
    overrides: &[String],
    seed: u64,
    laps: u32,
) -> Result<(f64, PathMetrics), ScenarioError> {
    let failed = |reason: Box<dyn Error + Send + Sync>| ScenarioError::new(scenario, reason);
    let resolved = kinds::load(scenario, overrides, Some(seed)).map_err(|e| failed(e.into()))?;
    let patrol = Patrol::from_scenario(&resolved, None, None).map_err(|e| failed(e.into()))?;
    let planned = patrol.laps(laps).map_err(|e| failed(e.into()))?;
    let metrics = planned
        .metrics
        .ok_or_else(|| failed("it has no laps".into()))?;
    Ok((patrol.v(), metrics))
}
