//! Grids of coloured cells.

use foxglove::messages::packed_element_field::NumericType;
use foxglove::messages::{Grid, Vector2};

use super::primitives::{MAP_FRAME, packed_fields, pose, timestamp};

/// Size of a cell (bytes): red, green, blue, alpha.
pub(super) const CELL_BYTES: usize = 4;

/// Returns `true` if the grid is not empty and has this many cells.
pub(super) fn fits(width: u32, height: u32, cells: usize) -> bool {
    cells > 0 && u64::from(width) * u64::from(height) == cells as u64
}

/// Position and size of a grid.
pub(super) struct GridPlace {
    /// Outer corner of the first cell (m).
    pub(super) origin: [f64; 2],
    /// Side of a cell (m).
    pub(super) resolution: f64,
    /// Number of columns.
    pub(super) width: u32,
}

/// Creates a grid of red, green, blue and alpha bytes; returns `None` if the size of a row overflows.
pub(super) fn coloured(place: &GridPlace, time_ns: u64, data: Vec<u8>) -> Option<Grid> {
    let row_stride = place.width.checked_mul(CELL_BYTES as u32)?;
    Some(Grid {
        timestamp: Some(timestamp(time_ns)),
        frame_id: MAP_FRAME.to_owned(),
        pose: Some(pose(place.origin[0], place.origin[1], 0.0, 0.0)),
        column_count: place.width,
        cell_size: Some(Vector2 {
            x: place.resolution,
            y: place.resolution,
        }),
        row_stride,
        cell_stride: CELL_BYTES as u32,
        fields: packed_fields(
            NumericType::Uint8,
            &[("red", 0), ("green", 1), ("blue", 2), ("alpha", 3)],
        ),
        data: data.into(),
    })
}
