//! Dominance regions over time, as a coarse grid.

use ipc_types::messages::referee::{DominanceCell, DominanceHeader};
use serde_json::{Value as Json, json};

use super::thinning::{Sample, ThinnedSeries};
use crate::run_model::is_grid;

const SECOND: u64 = 1_000_000_000;
/// Maximum number of cells along a side of the grid on the page.
const MAX_SIDE: usize = 96;
/// Maximum number of cells of all grids.
const ALL_CELLS: usize = 2_000_000;

/// Dominance regions, thinned out in space and time. All have the grid of the first.
#[derive(Debug, Clone)]
pub struct Regions {
    grid: Option<Grid>,
    /// Owners of the cells, row by row from the smallest y.
    owners: ThinnedSeries<Vec<u8>>,
}

/// The grid of a message, and how many of its cells are one on the page.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Grid {
    width: usize,
    height: usize,
    every: usize,
    origin: [f64; 2],
    side: f64,
}

impl Default for Regions {
    fn default() -> Self {
        Self {
            grid: None,
            owners: ThinnedSeries::new(SECOND, ALL_CELLS, Vec::len),
        }
    }
}

impl Regions {
    /// Adds regions; ignores those whose cells do not match their header, and those of another grid.
    pub(super) fn push(&mut self, time_ns: u64, header: &DominanceHeader, cells: &[DominanceCell]) {
        let (width, height) = (header.width as usize, header.height as usize);
        let origin = [header.origin_x, header.origin_y];
        let side = header.resolution;
        let is_sound = is_grid(cells.len(), width, header.height, side, origin);
        let grid = Grid {
            width,
            height,
            every: width.max(height).div_ceil(MAX_SIDE).max(1),
            origin,
            side,
        };
        if !is_sound || *self.grid.get_or_insert(grid) != grid || !self.owners.is_due(time_ns, 0) {
            return;
        }
        // Each cell of the page has the owner of the cell in its middle.
        let middle = |index: usize, length: usize| (index + grid.every / 2).min(length - 1);
        let rows = (0..height).step_by(grid.every);
        let owners = rows.flat_map(|row| {
            let start = middle(row, height) * width;
            let columns = (0..width).step_by(grid.every);
            columns.map(move |column| start + middle(column, width))
        });
        let owners = owners.filter_map(|cell| cells.get(cell));
        let owners = owners.map(|cell| cell.owner).collect();
        self.owners.push(time_ns, 0, owners);
    }

    /// Returns size, origin and side of the cells for the page; `null` without regions.
    pub(super) fn grid(&self) -> Json {
        self.grid.as_ref().map_or(Json::Null, |grid| {
            let size = [grid.width, grid.height].map(|cells| cells.div_ceil(grid.every));
            json!({ "size": size, "origin": grid.origin, "side": grid.side * grid.every as f64 })
        })
    }

    /// Returns the owners by time.
    pub(super) fn finish(self) -> Vec<Sample<Vec<u8>>> {
        self.owners.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fine_grid_becomes_coarse_and_keeps_its_place() {
        let header = DominanceHeader {
            width: 200,
            height: 100,
            resolution: 0.1,
            origin_x: -3.0,
            ..DominanceHeader::default()
        };
        // The Police on the left half, evaders on the right one.
        let cell = |i: usize| DominanceCell {
            owner: if i % 200 < 100 { 1 } else { 2 },
            ..DominanceCell::default()
        };
        let cells: Vec<DominanceCell> = (0..200 * 100).map(cell).collect();
        let mut regions = Regions::default();
        assert_eq!(regions.grid(), Json::Null);
        regions.push(0, &header, &cells[1..]);
        regions.push(0, &header, &cells);
        regions.push(SECOND / 2, &header, &cells);
        let other = DominanceHeader {
            origin_x: 1.0,
            ..header
        };
        regions.push(2 * SECOND, &other, &cells);
        let grid = regions.grid();
        assert_eq!(grid["size"], json!([67, 34]));
        assert_eq!(grid["origin"], json!([-3.0, 0.0]));
        let all = regions.finish();
        assert_eq!(all.len(), 1);
        assert_eq!(all[0].item.len(), 67 * 34);
        let first_row = all[0].item.iter().take(67);
        assert_eq!(
            first_row.map(|owner| u32::from(*owner == 1)).sum::<u32>(),
            33
        );
    }
}
