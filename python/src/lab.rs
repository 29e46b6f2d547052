//! Computations of `protean_robotics.lab` without a mission.

use std::path::PathBuf;

use chaotic_maps::Emission;
use geometry::map::{Occupancy, RosMap};
use kinds::KINDS;
use numpy::{IntoPyArray as _, PyArray2, PyArrayMethods as _};
use published::{laps, plans, sequences};
use pyo3::prelude::*;
use scenario::Loader;
use scenario::files::{Base, PathRefusal, ScenarioFile};

use python_algorithms::arguments::invalid;
use python_algorithms::error::Error;
use python_algorithms::interruptible::{compute, short};

/// Planner, scene, path and shortest path: length and smallest distance from a pursuer (m).
type Plan = (
    &'static str,
    &'static str,
    Option<[f64; 2]>,
    Option<[f64; 2]>,
);

/// Single plans of the RRT* planners.
///
/// Raises
/// ------
/// Error
///     The built-in scenario is unusable.
#[pyfunction]
pub fn single_plans(py: Python<'_>, seed: u64, iterations: u32) -> PyResult<Vec<Plan>> {
    let plans = compute(py, move || plans::of_seed(seed, iterations))?;
    let plans = plans.map_err(|error| Error::new_err(error.to_string()))?;
    let fields = |plan: plans::Plan| (plan.case, plan.scene, plan.path, plan.shortest);
    Ok(plans.into_iter().map(fields).collect())
}

/// Speed along the contour (m/s), and of the first laps of a patrol: speed (m/s) and length (m) of the first, mean distance
/// from the contour (m), mean angle of the first between turns and folded to acute ones (rad), changes of direction (1/s).
///
/// Raises
/// ------
/// Error
///     The scenario has no such patrol.
#[pyfunction]
pub fn patrol_laps(
    py: Python<'_>,
    scenario: &str,
    overrides: Vec<String>,
    seed: u64,
    laps: u32,
) -> PyResult<(f64, [f64; 6])> {
    let found = short(py, || laps::of_seed(scenario, &overrides, seed, laps));
    let (v, m) = found.map_err(|error| Error::new_err(error.to_string()))?;
    let turns = m.turns_first;
    let metrics = [
        m.speed_first,
        m.length_first,
        m.mae_time,
        turns.maa,
        turns.maa_fold,
        m.andc,
    ];
    Ok((v, metrics))
}

/// Key of the exact Chebyshev map for a seed.
#[pyfunction]
pub fn chebyshev_key(seed: u64) -> [u64; 2] {
    sequences::key(seed)
}

/// Mean difference of the coordinates of points of the Chebyshev map, raw or by the arcsine law: of the exact map under a
/// key, else in floating point from the paper's first values.
///
/// Raises
/// ------
/// InvalidInput
///     A key that the map does not take.
#[pyfunction]
#[pyo3(signature = (raw, count, key=None))]
pub fn chebyshev_difference(raw: bool, count: usize, key: Option<[u64; 2]>) -> PyResult<f64> {
    let emission = if raw {
        Emission::Raw
    } else {
        Emission::Arcsine
    };
    sequences::difference(emission, count, key).map_err(invalid)
}

/// Lyapunov exponents (per step) along orbits of the Chebyshev map and of its arcsine transform.
#[pyfunction]
pub fn chebyshev_exponents() -> [f64; 2] {
    sequences::exponents()
}

/// Cells of a map of ROS that are not free, their side (m) and the corner of the first (m).
///
/// Raises
/// ------
/// InvalidInput
///     The map or its image is invalid, or the image lies outside the folder without permission.
#[pyfunction]
pub fn ros_map(
    py: Python<'_>,
    path: PathBuf,
    allow_outside: bool,
) -> PyResult<(Bound<'_, PyArray2<bool>>, f64, [f64; 2])> {
    let map = RosMap::read(&path).map_err(invalid)?;
    let image = map.image.to_string_lossy().into_owned();
    let folder = path.parent().filter(|path| !path.as_os_str().is_empty());
    let base = Base::Folder {
        folder: folder.unwrap_or(".".as_ref()).to_owned(),
        allow_outside,
    };
    let refused =
        |refused: PathRefusal| invalid(format!("{} refers to {image}: {refused}", path.display()));
    let found = match base.find(&image).map_err(refused)? {
        ScenarioFile::Disk(file) => file,
        ScenarioFile::Text(_) => PathBuf::from(&image),
    };
    let cells = compute(py, move || map.load_image(&found))?.map_err(invalid)?;
    let frame = cells.frame;
    let is_occupied = |cell: Occupancy| cell != Occupancy::Free;
    let occupied: Vec<bool> = cells.cells.into_iter().map(is_occupied).collect();
    let occupied = occupied.into_pyarray(py);
    let occupied = occupied.reshape([frame.height, frame.width])?;
    Ok((occupied, frame.resolution, [frame.origin.x, frame.origin.y]))
}

/// Problems of a scenario that uses no file: of the first seed that has any, from 1 to this one.
#[pyfunction]
pub fn scenario_problems(py: Python<'_>, text: String, seeds: u64) -> PyResult<Vec<String>> {
    let check = move || {
        let loader = Loader::new(KINDS);
        let draft = loader.draft_text("scenario.toml", &text, &Base::Nothing)?;
        (1..=seeds).try_for_each(|seed| {
            let mut draft = draft.clone();
            draft.apply("--seed", &format!("run.seed={seed}"));
            draft.resolve().map(drop)
        })
    };
    let Err(problems) = compute(py, check)? else {
        return Ok(Vec::new());
    };
    // Without their places, which are those of a text in memory alone.
    let texts = problems.iter().map(|problem| match &problem.value {
        Some(value) => format!("{} ({value})", problem.message),
        None => problem.message.clone(),
    });
    Ok(texts.collect())
}
