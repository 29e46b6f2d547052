//! The map of a planner: made of `world/map`, and of `world/shapes` if it plans among exact pieces.

use std::sync::{Arc, OnceLock};

use planner_view::free_space::FreeSpace;
use planner_view::map::PlannerMap;
use runtime::error::ProcessError;
use runtime::grids::{MapGrids, blurred_map, map_grids};
use runtime::inputs::{MapInput, ShapesInput};

/// Planners' maps of one map message, which processes of one thread make once.
#[derive(Debug, Default)]
struct PlannerMaps {
    /// Of the grids alone.
    grids: OnceLock<Arc<PlannerMap>>,
    /// With the exact pieces of `world/shapes`.
    exact: OnceLock<Arc<PlannerMap>>,
}

/// The planner's map of the newest map message; `shapes` are the exact pieces of the same revision,
/// `is_shared` says that several planners use it. Processes of one thread make it once.
///
/// # Errors
/// [`ProcessError::Protocol`] if the messages make no map.
pub fn planner_map(
    input: &MapInput,
    shapes: Option<&ShapesInput>,
    is_shared: bool,
) -> Result<Arc<PlannerMap>, ProcessError> {
    let Some(maps) = input.derived::<PlannerMaps>() else {
        let is_shared = is_shared || input.is_shared();
        return Ok(Arc::new(make_map(input, shapes, is_shared)?));
    };
    let place = if shapes.is_some() {
        &maps.exact
    } else {
        &maps.grids
    };
    if let Some(map) = place.get() {
        return Ok(Arc::clone(map));
    }
    let map = Arc::new(make_map(input, shapes, true)?);
    // Another thread may have been faster: all share its map.
    Ok(Arc::clone(place.get_or_init(|| map)))
}

fn make_map(
    input: &MapInput,
    shapes: Option<&ShapesInput>,
    is_shared: bool,
) -> Result<PlannerMap, ProcessError> {
    let MapGrids {
        blurred,
        occupied,
        clearance,
    } = map_grids(input);
    let blurred = blurred_map(blurred, occupied)?;
    let map = PlannerMap::new(blurred, clearance, u64::from(input.header.revision))
        .map_err(|e| ProcessError::Protocol(format!("world/map: {e}")))?;
    let map = if is_shared { map.shared() } else { map };
    Ok(match shapes.map(|s| &s.pieces) {
        None => map,
        Some(Some((bounds, parts))) => {
            let space = FreeSpace::new(parts.clone(), *bounds, input.header.resolution)
                .map_err(|e| ProcessError::Protocol(format!("world/shapes: {e}")))?;
            map.with_space(Arc::new(space))
        }
        Some(None) => {
            tracing::warn!(
                "the map has too many pieces for world/shapes: planning goes by the grid"
            );
            map
        }
    })
}
