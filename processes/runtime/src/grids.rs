//! Conversion of the map message to the grids of the algorithms.

use geometry::blur::BlurredMap;
use geometry::grid::{Grid, GridFrame};
use ipc_types::messages::world::{MapCell, MapHeader};
use nalgebra::Point2;

use crate::error::ProcessError;

/// Converts a map message to grids.
pub struct MapGrids {
    /// Gaussian blur of the free map, not masked.
    pub blurred: Grid<f32>,
    /// Cells whose centre is in an obstacle.
    pub occupied: Grid<bool>,
    /// Distance from the cell's centre to the nearest obstacle (m).
    pub clearance: Grid<f32>,
}

/// The grids of a map message.
pub fn map_grids(header: &MapHeader, cells: &[MapCell]) -> MapGrids {
    let frame = GridFrame {
        width: header.width as usize,
        height: header.height as usize,
        resolution: header.resolution,
        origin: Point2::new(header.origin_x, header.origin_y),
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
