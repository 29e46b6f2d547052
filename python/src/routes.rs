//! Routes of scenarios without a run: plans and predictions of patrols, plans of coverages.

use kinds::KINDS;
use plan::routes::coverage::{self, Extent};
use plan::routes::patrol::Patrol;
use pyo3::prelude::*;
use scenario::{Loader, ResolvedScenario};

use python_algorithms::arguments::{invalid, refused};
use python_algorithms::interruptible::compute;

/// Maximum number of laps of a plan.
const MAX_LAPS: u32 = 10_000;
/// Maximum number of loops of a plan.
const MAX_LOOPS: u32 = 100_000;

/// A scenario and its process: name or path, overrides, seed, whether files outside its folder may be used, process.
type Source = (String, Vec<String>, Option<u64>, bool, Option<String>);

fn load(source: Source) -> PyResult<(ResolvedScenario, Option<String>)> {
    let (scenario, overrides, seed, allow_outside, process) = source;
    let loader = Loader::new(KINDS).allow_outside(allow_outside);
    let loaded = loader.load(&scenario, &overrides, seed);
    Ok((loaded.map_err(invalid)?, process))
}

fn patrol_of(source: Source, key: Option<&str>) -> PyResult<Patrol> {
    let (scenario, process) = load(source)?;
    let key = key.map(str::parse).transpose();
    let key = key.map_err(invalid)?;
    Patrol::from_scenario(&scenario, process.as_deref(), key).map_err(invalid)
}

/// Waypoints of the first laps of a patrol and their metrics, as JSON.
#[pyfunction]
pub fn plan_patrol(
    py: Python<'_>,
    source: Source,
    key: Option<String>,
    laps: u32,
) -> PyResult<String> {
    if laps > MAX_LAPS {
        return Err(refused("laps", &laps, "at most 10 000"));
    }
    compute(py, move || {
        let patrol = patrol_of(source, key.as_deref())?;
        let plan = patrol.plan_json(laps).map_err(invalid)?;
        Ok(plan.to_string())
    })?
}

/// Positions of a patrol at times (s), and its waypoints by their numbers, as JSON.
#[pyfunction]
pub fn predict_patrol(
    py: Python<'_>,
    source: Source,
    key: Option<String>,
    at: Vec<f64>,
    waypoints: Vec<u64>,
) -> PyResult<String> {
    compute(py, move || {
        let patrol = patrol_of(source, key.as_deref())?;
        let predicted = patrol.prediction_json(&at, &waypoints);
        Ok(predicted.map_err(invalid)?.to_string())
    })?
}

/// Sub-goals of a coverage, up to a number of loops, of sub-goals or a length (m), and what they cover, as JSON.
#[pyfunction]
pub fn plan_coverage(
    py: Python<'_>,
    source: Source,
    loops: Option<u32>,
    goals: Option<u64>,
    length: Option<f64>,
) -> PyResult<String> {
    let extent = match (loops, goals, length) {
        (Some(loops), ..) if loops > MAX_LOOPS => {
            return Err(refused("loops", &loops, "at most 100 000"));
        }
        (loops, None, None) => Extent::Loops(loops.unwrap_or(1)),
        (None, Some(goals), None) => Extent::Goals(goals),
        (None, None, Some(length)) if length > 0.0 => Extent::Length(length),
        (None, None, Some(length)) => return Err(refused("length", &length, "above 0 (m)")),
        _ => return Err(refused("loops", &"given", "one of loops, goals and length")),
    };
    compute(py, move || {
        let (scenario, process) = load(source)?;
        let planned = coverage::plan(&scenario, process.as_deref(), extent);
        Ok(planned.map_err(invalid)?.json().to_string())
    })?
}
