//! Map of a planner: made from `world/map`, and from `world/shapes` if it plans among exact pieces.

use std::sync::{Arc, OnceLock};

use planner_view::free_space::FreeSpace;
use planner_view::map::PlannerMap;
use runtime::error::ProcessError;
use runtime::grids::{MapGrids, blurred_map, map_grids};
use runtime::inputs::{MapInput, ShapesInput};

/// Planners' maps of one map message; processes of one thread build them once.
#[derive(Debug, Default)]
struct PlannerMaps {
    /// Map of the grids alone.
    grids: OnceLock<Arc<PlannerMap>>,
    /// Map with the exact pieces of `world/shapes`.
    exact: OnceLock<Arc<PlannerMap>>,
}

/// Returns the planner's map of the newest map message. `shapes` are the exact pieces of the same
/// revision; `is_shared` is `true` if several planners use it. Processes of one thread build it
/// once.
///
/// # Errors
/// [`ProcessError::Protocol`] if the messages are no valid map.
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
    } = map_grids(&input.header, input.cells());
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
            tracing::warn!("the map has too many pieces for world/shapes: planning uses the grid");
            map
        }
    })
}
