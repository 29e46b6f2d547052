//! Conversion of the map message to the grids of the algorithms.

use geometry::blur::BlurredMap;
use geometry::grid::{Grid, GridFrame};
use nalgebra::Point2;

use crate::error::ProcessError;
use crate::inputs::MapInput;

/// Converts a map message to grids.
pub struct MapGrids {
    /// Gaussian blur of the free map, not masked.
    pub blurred: Grid<f32>,
    /// Cells whose centre is in an obstacle.
    pub occupied: Grid<bool>,
    /// Distance from the cell's centre to the nearest obstacle (m).
    pub clearance: Grid<f32>,
}

/// The grids of the newest map.
pub fn map_grids(map: &MapInput) -> MapGrids {
    let cells = map.cells();
    let frame = GridFrame {
        width: map.header.width as usize,
        height: map.header.height as usize,
        resolution: map.header.resolution,
        origin: Point2::new(map.header.origin_x, map.header.origin_y),
    };
    MapGrids {
        blurred: Grid {
            frame,
            cells: cells.iter().map(|c| c.blurred).collect(),
        },
        occupied: Grid {
            frame,
            cells: cells.iter().map(|c| c.occupied != 0).collect(),
        },
        clearance: Grid {
            frame,
            cells: cells.iter().map(|c| c.clearance).collect(),
        },
    }
}

/// Returns the blurred map of the layers of a map message.
///
/// # Errors
/// [`ProcessError::Protocol`] if the layers are no valid map.
pub fn blurred_map(blurred: Grid<f32>, occupied: Grid<bool>) -> Result<BlurredMap, ProcessError> {
    BlurredMap::from_parts(blurred, occupied)
        .map_err(|e| ProcessError::Protocol(format!("world/map: {e}")))
}
