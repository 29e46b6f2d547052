//! The map as grids: occupancy of the cells, and distance of each cell's centre from the nearest
//! obstacle.

use super::index::{ShapeIndex, edge_distance};
use crate::grid::{Grid, GridFrame};
use crate::shape::{Aabb, Convex};

/// Occupancy and clearance, computed exactly at every cell centre.
///
/// A cell is occupied if its centre lies in an obstacle (border included) or beyond the edge of
/// the map; its clearance (m) is 0 then.
pub fn grids(
    frame: GridFrame,
    bounds: Aabb,
    parts: &[Convex],
    index: &ShapeIndex,
) -> (Grid<bool>, Grid<f32>) {
    let mut occupancy = Grid::filled(frame, false);
    let mut clearance = Grid::filled(frame, 0.0f32);
    let k = index.cells_per_bucket;
    for bucket_row in 0..index.frame.height {
        for bucket_col in 0..index.frame.width {
            let candidates = index.nearest_in(bucket_col, bucket_row);
            for row in bucket_row * k..((bucket_row + 1) * k).min(frame.height) {
                for col in bucket_col * k..((bucket_col + 1) * k).min(frame.width) {
                    let p = frame.center(col, row);
                    let mut distance = edge_distance(&bounds, p).max(0.0);
                    for &i in candidates {
                        distance = distance.min(parts[i as usize].distance(p));
                    }
                    let cell = frame.index(col, row);
                    occupancy.cells[cell] = distance == 0.0;
                    clearance.cells[cell] = distance as f32;
                }
            }
        }
    }
    (occupancy, clearance)
}
