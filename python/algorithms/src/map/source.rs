//! Maps from scenarios and files.

use std::path::Path;
use std::sync::Arc;

use geometry::blur::PAPER_SIGMA;
use geometry::map::{MapSpec, UnknownCells, WorldMap};
use kinds::KINDS;
use planner_view::map::PlannerMap;
use platform::file_kind::FileKind;
use pyo3::prelude::*;
use scenario::spec::MAX_CELLS;
use scenario::{Draft, Loader};

use crate::arguments::{at_most, invalid};

/// First revision of a map, as in runs.
pub const FIRST_REVISION: u64 = 1;

/// Returns the map of a built-in scenario, of a scenario's file, or of a map's file (TOML, or YAML of ROS).
///
/// # Errors
/// The text of the command for a scenario that is invalid, and for a file that is neither.
pub fn read(source: &str) -> PyResult<Arc<PlannerMap>> {
    let path = Path::new(source);
    let is_ros = matches!(
        path.extension().and_then(|e| e.to_str()),
        Some("yaml" | "yml")
    );
    if !is_ros && FileKind::from_path(path) != Some(FileKind::VectorMap) {
        let scenario = Loader::new(KINDS)
            .draft(source)
            .and_then(Draft::resolve)
            .map_err(invalid)?;
        return of_spec(&scenario.world.map, scenario.blur_sigma);
    }
    let file = MapSpec::File {
        path: source.into(),
        unknown: UnknownCells::default(),
    };
    let spec = file.load(Path::new("")).map_err(invalid)?;
    of_spec(&spec, PAPER_SIGMA)
}

fn of_spec(spec: &MapSpec, blur_sigma: f64) -> PyResult<Arc<PlannerMap>> {
    let world = WorldMap::recent(spec).map_err(invalid)?;
    at_most("source", world.frame().len(), MAX_CELLS)?;
    of_world(&world, blur_sigma)
}

/// Returns the map that the planners of a run would get.
///
/// # Errors
/// The blur does not fit the map.
pub fn of_world(world: &WorldMap, blur_sigma: f64) -> PyResult<Arc<PlannerMap>> {
    PlannerMap::of_world(world, blur_sigma, FIRST_REVISION)
        .map(Arc::new)
        .map_err(invalid)
}
