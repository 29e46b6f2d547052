//! The cells that a disc has swept.

use nalgebra::Point2;

use super::{Axis, CellGrid, Lattice};

/// Cells whose centres came within a radius of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct SweptCells {
    grid: CellGrid,
    cells: Lattice,
    radius: f64,
    reached: Vec<bool>,
    covered: usize,
}

impl SweptCells {
    /// Creates the cells without any sweep by a disc of `radius` (m).
    pub fn new(grid: CellGrid, radius: f64) -> Self {
        Self {
            reached: vec![false; grid.len()],
            cells: grid.lattice(),
            grid,
            radius,
            covered: 0,
        }
    }

    /// The cells.
    pub fn grid(&self) -> &CellGrid {
        &self.grid
    }

    /// Sweeps the disc straight from one point to another (m); ignores points that are not finite.
    pub fn sweep(&mut self, from: Point2<f64>, to: Point2<f64>) {
        if ![from.x, from.y, to.x, to.y].iter().all(|x| x.is_finite()) {
            return;
        }
        let (grid, reached) = (&self.grid, &mut self.reached);
        let mut covered = 0;
        self.cells
            .each_span(from, to, self.radius, Axis::Rows, |span| {
                let start = span.line * span.cells;
                for cell in start + span.first..=start + span.last {
                    if let Some(reached @ false) = reached.get_mut(cell) {
                        *reached = true;
                        covered += usize::from(grid.is_coverable(cell));
                    }
                }
            });
        self.covered += covered;
    }

    /// Per cell, `true` if its centre has been swept.
    pub fn cells(&self) -> &[bool] {
        &self.reached
    }

    /// Number of swept coverable cells.
    pub fn covered(&self) -> usize {
        self.covered
    }

    /// The coverage rate C, from 0 to 1.
    pub fn rate(&self) -> f64 {
        self.covered as f64 / self.grid.coverable() as f64
    }
}
