//! Free space that a robot has not covered yet, and the gain of a leg.

#[cfg(test)]
mod tests;

use metrics::coverage::{Axis, CellGrid, Lattice, Span};
use nalgebra::Point2;

use crate::space::Space;

/// Tolerance (m) beyond the disc's radius or the free space, as in the metric of coverage: rounding
/// must not decide.
const TOLERANCE: f64 = 1e-9;

/// The cells of the reachable free space that the disc has not swept in this round.
///
/// A cell counts by its centre. Every fresh cell has a *worth*: 1 among fresh cells, and up to `1 +
/// rarity` if few of its neighbours are fresh, because a return to slivers costs the most. Sums
/// along rows make the worth of a leg cheap: a disc swept along a segment is convex, so that it
/// meets each row of cells in one interval.
#[derive(Debug, Clone, PartialEq)]
pub struct Freshness {
    cells: Lattice,
    radius: f64,
    rarity: f64,
    neighbourhood: usize,
    reachable: Vec<bool>,
    total: usize,
    fresh: Vec<bool>,
    left: usize,
    /// Per row, `columns + 1` sums of the worth left of a column.
    along_rows: Vec<f32>,
    /// Per column, `rows + 1` sums of the worth below a row.
    along_columns: Vec<f32>,
    worth: f64,
    /// Fresh cells left of and above each corner of the grid; kept to reuse its memory.
    corners: Vec<u32>,
}

impl Freshness {
    /// Creates the cells, all reachable ones fresh; `radius` (m) of the disc, > 0. The neighbours
    /// of a cell are those up to `neighbourhood` cells away along both axes.
    pub fn new(
        grid: &CellGrid,
        space: &Space,
        radius: f64,
        rarity: f64,
        neighbourhood: usize,
    ) -> Self {
        let near = |p| space.rectangles().any(|r| r.distance(p) <= TOLERANCE);
        let reachable: Vec<bool> = (0..grid.len())
            .map(|cell| grid.is_coverable(cell) && near(grid.center(cell)))
            .collect();
        let total = reachable.iter().filter(|&&cell| cell).count();
        let (columns, rows) = (grid.columns(), grid.rows());
        let mut freshness = Self {
            cells: grid.lattice(),
            radius,
            rarity,
            neighbourhood,
            fresh: reachable.clone(),
            reachable,
            total,
            left: total,
            along_rows: vec![0.0; (columns + 1) * rows],
            along_columns: vec![0.0; (rows + 1) * columns],
            worth: 0.0,
            corners: vec![0; (columns + 1) * (rows + 1)],
        };
        freshness.weigh();
        freshness
    }

    /// Makes all cells fresh again.
    pub fn renew(&mut self) {
        self.fresh.clone_from(&self.reachable);
        self.left = self.total;
        self.weigh();
    }

    /// Copies the covered cells of another one, if the grids are equal.
    pub fn keep_covered(&mut self, before: &Self) {
        if self.cells != before.cells {
            return;
        }
        let pairs = before.reachable.iter().zip(&before.fresh);
        for (cell, (&reachable, &fresh)) in self.fresh.iter_mut().zip(pairs) {
            *cell &= fresh || !reachable;
        }
        self.left = self.fresh.iter().filter(|&&cell| cell).count();
        self.weigh();
    }

    /// Share of the reachable cells that are fresh, from 0 to 1.
    pub fn share(&self) -> f64 {
        self.left as f64 / self.total.max(1) as f64
    }

    /// Mean worth of the reachable cells, from 0 to 1 + rarity.
    pub fn mean_worth(&self) -> f64 {
        self.worth / self.total.max(1) as f64
    }

    /// Number of fresh cells.
    pub fn left(&self) -> usize {
        self.left
    }

    /// Centre of the fresh cell number `index` (m), counted row by row.
    pub fn nth(&self, index: usize) -> Option<Point2<f64>> {
        let mut fresh = self.fresh.iter().enumerate().filter(|&(_, &fresh)| fresh);
        fresh.nth(index).map(|(cell, _)| self.cells.center(cell))
    }

    /// Worth of the cells that the disc would sweep on the straight leg between two finite points
    /// (m²).
    pub fn worth_of(&self, from: Point2<f64>, to: Point2<f64>) -> f64 {
        // Lines of cells along the leg are fewer than those across it.
        let line = to - from;
        let (axis, sums) = if line.y.abs() > line.x.abs() {
            (Axis::Columns, &self.along_columns)
        } else {
            (Axis::Rows, &self.along_rows)
        };
        let mut worth = 0.0_f64;
        self.cells.each_span(from, to, self.radius, axis, |span| {
            let start = span.line * (span.cells + 1);
            let sum = |cell: usize| sums.get(start + cell).copied().unwrap_or(0.0);
            worth += f64::from(sum(span.last + 1) - sum(span.first));
        });
        worth * self.cells.side() * self.cells.side()
    }

    /// Sweeps the disc along a straight leg between two finite points (m); returns the number of
    /// fresh cells that it met.
    pub fn sweep(&mut self, from: Point2<f64>, to: Point2<f64>) -> usize {
        let before = self.left;
        let fresh = &mut self.fresh;
        let mut swept = 0;
        let rows = Axis::Rows;
        self.cells
            .each_span(from, to, self.radius, rows, |span: Span| {
                let start = span.line * span.cells;
                let cells = fresh.get_mut(start + span.first..=start + span.last);
                for cell in cells.into_iter().flatten() {
                    swept += usize::from(*cell);
                    *cell = false;
                }
            });
        self.left = before - swept;
        if swept > 0 {
            self.weigh();
        }
        swept
    }

    /// Number of fresh cells that the disc would sweep from one place to another (m).
    pub fn fresh_on(&self, from: Point2<f64>, to: Point2<f64>) -> usize {
        let mut found = 0;
        let rows = Axis::Rows;
        self.cells.each_span(from, to, self.radius, rows, |span| {
            let start = span.line * span.cells;
            let cells = self.fresh.get(start + span.first..=start + span.last);
            found += cells.into_iter().flatten().filter(|cell| **cell).count();
        });
        found
    }

    /// Recomputes the worth of all cells.
    fn weigh(&mut self) {
        let (columns, rows) = (self.cells.columns(), self.cells.rows());
        let wide = columns + 1;
        for row in 0..rows {
            let mut run = 0;
            for column in 0..columns {
                let cell = row * columns + column;
                run += u32::from(self.fresh.get(cell).copied().unwrap_or(false));
                let corner = row * wide + column + 1;
                let above = self.corners.get(corner).copied().unwrap_or(0);
                if let Some(own) = self.corners.get_mut(corner + wide) {
                    *own = above + run;
                }
            }
        }
        let reach = self.neighbourhood;
        let most = ((2 * reach + 1) * (2 * reach + 1)) as f64;
        let (most, scale) = (most, self.rarity / most);
        let corner = |row: usize, column: usize| {
            let value = self.corners.get(row * wide + column);
            f64::from(value.copied().unwrap_or(0))
        };
        let mut total = 0.0;
        for row in 0..rows {
            let (top, bottom) = (row.saturating_sub(reach), (row + reach + 1).min(rows));
            let mut sum = 0.0;
            for column in 0..columns {
                let mut worth = 0.0;
                if self.fresh.get(row * columns + column) == Some(&true) {
                    let left = column.saturating_sub(reach);
                    let right = (column + reach + 1).min(columns);
                    let around = corner(bottom, right) - corner(top, right) - corner(bottom, left)
                        + corner(top, left);
                    worth = 1.0 + scale * (most - around);
                    sum += worth;
                }
                if let Some(own) = self.along_rows.get_mut(row * wide + column + 1) {
                    *own = sum as f32;
                }
                let cell = column * (rows + 1) + row;
                if let Some([below, own]) = self.along_columns.get_mut(cell..cell + 2) {
                    *own = *below + worth as f32;
                }
            }
            total += sum;
        }
        self.worth = total;
    }
}
