//! Grids of coloured cells.

use foxglove::messages::packed_element_field::NumericType;
use foxglove::messages::{Grid, Vector2};

use super::primitives::{MAP_FRAME, packed_fields, pose, timestamp};

/// Bytes of a cell: red, green, blue, alpha.
pub(super) const CELL_BYTES: usize = 4;

/// Whether that many cells are those of a grid of this size, which has some.
pub(super) fn fits(width: u32, height: u32, cells: usize) -> bool {
    cells > 0 && u64::from(width) * u64::from(height) == cells as u64
}

/// Where the cells of a grid lie.
pub(super) struct GridPlace {
    /// Outer corner of the first cell (m).
    pub(super) origin: [f64; 2],
    /// Side of a cell (m).
    pub(super) resolution: f64,
    /// Columns.
    pub(super) width: u32,
}

/// Cells of red, green, blue and alpha bytes; `None` if a row has more bytes than can be said.
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
