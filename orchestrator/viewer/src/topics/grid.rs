//! Grids of cells.

/// Returns `true` if the grid is not empty and has this many cells.
pub(super) fn fits(width: u32, height: u32, cells: usize) -> bool {
    cells > 0 && u64::from(width) * u64::from(height) == cells as u64
}
