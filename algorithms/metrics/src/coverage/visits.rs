//! Number of points per cell.

use nalgebra::Point2;

use super::CellGrid;

/// Counts points by cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Visits {
    grid: CellGrid,
    counts: Vec<u32>,
    covered: usize,
}

impl Visits {
    /// Creates the counts without points.
    pub fn new(grid: CellGrid) -> Self {
        Self {
            counts: vec![0; grid.len()],
            grid,
            covered: 0,
        }
    }

    /// The cells.
    pub fn grid(&self) -> &CellGrid {
        &self.grid
    }

    /// Counts a point (m).
    pub fn add(&mut self, p: Point2<f64>) {
        let cell = self.grid.cell_of(p);
        let coverable = self.grid.is_coverable(cell);
        if let Some(count) = self.counts.get_mut(cell) {
            self.covered += usize::from(*count == 0 && coverable);
            *count = count.saturating_add(1);
        }
    }

    /// Points per cell.
    pub fn counts(&self) -> &[u32] {
        &self.counts
    }

    /// Number of coverable cells with at least one point.
    pub fn covered(&self) -> usize {
        self.covered
    }

    /// The coverage rate C, from 0 to 1.
    pub fn rate(&self) -> f64 {
        self.covered as f64 / self.grid.coverable() as f64
    }

    /// Evenness: population standard deviation over mean of the points per coverable cell (the
    /// coefficient of variation); 0 for equal counts, infinite without points.
    pub fn variation(&self) -> f64 {
        let cells = self.grid.coverable() as f64;
        let counts = || {
            let cells = self.counts.iter().enumerate();
            cells
                .filter(|&(cell, _)| self.grid.is_coverable(cell))
                .map(|(_, &count)| f64::from(count))
        };
        let mean = counts().sum::<f64>() / cells;
        if mean == 0.0 {
            return f64::INFINITY;
        }
        let variance = counts().map(|c| (c - mean) * (c - mean)).sum::<f64>() / cells;
        variance.sqrt() / mean
    }
}
