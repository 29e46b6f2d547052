//! Street grid of the benches of visibility and of the particle filter.

use geometry::grid::{Grid, GridFrame};
use nalgebra::Point2;

/// Number of cells per side.
pub const SIDE: usize = 384;
/// Size of a cell (m).
pub const RESOLUTION: f64 = 1.0 / 64.0;
/// Standard deviation of the blur (m).
pub const BLUR: f64 = 6.0 * RESOLUTION;

/// Returns the free cells of 6 m × 6 m: a wall with one exit around 4 × 4 blocks of 0.766 m in
/// streets of 0.5625 m.
pub fn streets() -> Grid<bool> {
    let frame = GridFrame {
        width: SIDE,
        height: SIDE,
        resolution: RESOLUTION,
        origin: Point2::new(0.0, 0.0),
    };
    let mut free = Grid::filled(frame, true);
    let (block, street) = (0.766, 0.5625);
    let wall = (6.0 - 4.0 * block - 5.0 * street) / 2.0;
    let in_block = |c: f64| {
        let along = c - wall - street;
        along >= 0.0 && along < 4.0 * (block + street) && along % (block + street) < block
    };
    for row in 0..SIDE {
        for col in 0..SIDE {
            let p = frame.center(col, row);
            let border = p.x.min(p.y).min(6.0 - p.x) < wall;
            let top = 6.0 - p.y < wall && (p.x - 3.0).abs() > street / 2.0;
            free.cells[frame.index(col, row)] =
                !(border || top || (in_block(p.x) && in_block(p.y)));
        }
    }
    free
}
