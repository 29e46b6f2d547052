//! The cells of a workplace, and the coverable ones among them.

use nalgebra::Point2;

use super::{CoverageDomain, CoverageError, Lattice, MAX_CELLS, TOLERANCE};

/// Square cells over a workplace, from its smaller corner; row after row.
#[derive(Debug, Clone, PartialEq)]
pub struct CellGrid {
    origin: Point2<f64>,
    side: f64,
    columns: usize,
    rows: usize,
    coverable: Vec<bool>,
    coverable_count: usize,
}

impl CellGrid {
    /// Creates cells of this side (m); those at the far borders may extend beyond the workplace. A
    /// cell is coverable if its centre is free ([`CoverageDomain::is_free`]).
    ///
    /// # Errors
    /// [`CoverageError`] if there are too many cells or none is coverable.
    pub fn new(domain: &CoverageDomain, side: f64) -> Result<Self, CoverageError> {
        let bounds = domain.bounds();
        let size = bounds.max - bounds.min;
        let count = |length: f64| (length / side - TOLERANCE).ceil().max(1.0);
        let (columns, rows) = (count(size.x), count(size.y));
        let usable = side > 0.0 && columns * rows <= MAX_CELLS as f64;
        if !usable {
            return Err(CoverageError::CellSide { side });
        }
        let mut grid = Self {
            origin: bounds.min,
            side,
            columns: columns as usize,
            rows: rows as usize,
            coverable: Vec::new(),
            coverable_count: 0,
        };
        grid.coverable = (0..grid.len())
            .map(|cell| domain.is_free(grid.center(cell)))
            .collect();
        grid.coverable_count = grid.coverable.iter().filter(|&&c| c).count();
        if grid.coverable_count == 0 {
            return Err(CoverageError::NothingCoverable { side });
        }
        Ok(grid)
    }

    /// Side of the cells (m).
    pub fn side(&self) -> f64 {
        self.side
    }

    /// Number of columns, along x.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows, along y.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of all cells, coverable or not.
    pub fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// Returns `true` if there are no cells (never).
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Centre of a cell (m).
    pub fn center(&self, cell: usize) -> Point2<f64> {
        let (column, row) = (cell % self.columns, cell / self.columns);
        Point2::new(
            self.origin.x + (column as f64 + 0.5) * self.side,
            self.origin.y + (row as f64 + 0.5) * self.side,
        )
    }

    /// The centres of the cells.
    pub fn lattice(&self) -> Lattice {
        Lattice::new(self.center(0), self.side, [self.columns, self.rows])
    }

    /// The cell of a point (m): ⌊x/g + 10⁻⁹⌋ along each axis, clamped to the grid.
    pub fn cell_of(&self, p: Point2<f64>) -> usize {
        // A cast saturates and makes 0 of NaN: every point has a cell.
        let index = |offset: f64, count: usize| {
            ((offset / self.side + TOLERANCE).floor() as usize).min(count - 1)
        };
        let column = index(p.x - self.origin.x, self.columns);
        index(p.y - self.origin.y, self.rows) * self.columns + column
    }

    /// Returns `true` if a cell can be covered; `false` beyond the grid.
    pub fn is_coverable(&self, cell: usize) -> bool {
        self.coverable.get(cell).copied().unwrap_or(false)
    }

    /// Number of coverable cells, `M`; at least 1.
    pub fn coverable(&self) -> usize {
        self.coverable_count
    }
}
