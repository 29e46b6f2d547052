//! The grid of the borders of obstacles, and its free cells.

use geometry::shape::Aabb;
use nalgebra::Point2;

use super::{DecompositionError, MAX_CELLS, SAME};
use crate::workplace::Workplace;

/// Cells between lines along both axes.
pub struct Cells {
    /// Lines across x (m), increasing; at least 2.
    xs: Vec<f64>,
    /// Lines across y (m), increasing; at least 2.
    ys: Vec<f64>,
    /// Per cell, row after row.
    free: Vec<bool>,
    /// Axis across which the lines between strips run.
    axis: usize,
    /// Per column (or row) along this axis, its strip.
    strips: Vec<usize>,
}

/// A rectangle of cells: columns `x0..=x1`, rows `y0..=y1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Block {
    // Compared in this order where two areas are the same.
    pub x0: usize,
    pub y0: usize,
    pub x1: usize,
    pub y1: usize,
}

impl Block {
    pub fn meets(&self, other: &Self) -> bool {
        self.x0 <= other.x1 && other.x0 <= self.x1 && self.y0 <= other.y1 && other.y0 <= self.y1
    }
}

impl Cells {
    /// Creates lines at all sides of the workplace and of the grown obstacles, and at `cuts` (m) across
    /// an axis, in ascending order; a cell is free if its centre lies in no obstacle.
    pub fn new(
        workplace: &Workplace,
        axis: usize,
        cuts: &[f64],
    ) -> Result<Self, DecompositionError> {
        let inner = workplace.inner();
        let lines = |across: usize| {
            let sides = workplace.inflated().iter();
            let mut all: Vec<f64> = sides.flat_map(|o| [o.min[across], o.max[across]]).collect();
            all.extend([inner.min[across], inner.max[across]]);
            all.extend(cuts.iter().filter(|_| across == axis));
            all.sort_by(f64::total_cmp);
            // Compared with the last kept line, so that a row of near ones does not collapse into
            // one.
            all.dedup_by(|next, kept| *next - *kept <= SAME);
            all
        };
        let (xs, ys) = (lines(0), lines(1));
        let (columns, rows) = (xs.len().saturating_sub(1), ys.len().saturating_sub(1));
        if columns * rows > MAX_CELLS {
            return Err(DecompositionError::TooManyCells {
                obstacles: workplace.inflated().len(),
                cells: columns * rows,
            });
        }
        let along = if axis == 0 { &xs } else { &ys };
        let strip = |pair: &[f64]| cuts.partition_point(|&cut| cut < 0.5 * (pair[0] + pair[1]));
        let strips = along.windows(2).map(strip).collect();
        let mut cells = Self {
            xs,
            ys,
            free: vec![true; columns * rows],
            axis,
            strips,
        };
        for obstacle in workplace.inflated() {
            cells.block(obstacle);
        }
        Ok(cells)
    }

    /// Marks the cells whose centres lie in an obstacle.
    fn block(&mut self, obstacle: &Aabb) {
        let span = |lines: &[f64], low: f64, high: f64| {
            let middles = || lines.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
            let first = middles().take_while(|&m| m < low).count();
            first..middles().take_while(|&m| m <= high).count()
        };
        let columns = span(&self.xs, obstacle.min.x, obstacle.max.x);
        let width = self.columns();
        for row in span(&self.ys, obstacle.min.y, obstacle.max.y) {
            for column in columns.clone() {
                if let Some(free) = self.free.get_mut(row * width + column) {
                    *free = false;
                }
            }
        }
    }

    pub fn columns(&self) -> usize {
        self.xs.len().saturating_sub(1)
    }

    pub fn rows(&self) -> usize {
        self.ys.len().saturating_sub(1)
    }

    pub fn count(&self) -> usize {
        self.free.len()
    }

    /// Per cell, whether it is a free one of a strip.
    pub fn free_in(&self, strip: usize) -> Vec<bool> {
        let columns = self.columns();
        let is_in = |(cell, &free): (usize, &bool)| {
            let along = [cell % columns, cell / columns][self.axis];
            free && self.strips.get(along) == Some(&strip)
        };
        self.free.iter().enumerate().map(is_in).collect()
    }

    /// Width (m) of columns `first..=last`.
    pub fn width(&self, first: usize, last: usize) -> f64 {
        distance(&self.xs, first, last)
    }

    /// Height (m) of rows `first..=last`.
    pub fn height(&self, first: usize, last: usize) -> f64 {
        distance(&self.ys, first, last)
    }

    /// The rectangle of a block of cells (m).
    pub fn aabb(&self, block: &Block) -> Aabb {
        let line = |lines: &[f64], index: usize| lines.get(index).copied().unwrap_or(f64::NAN);
        Aabb {
            min: Point2::new(line(&self.xs, block.x0), line(&self.ys, block.y0)),
            max: Point2::new(line(&self.xs, block.x1 + 1), line(&self.ys, block.y1 + 1)),
        }
    }
}

fn distance(lines: &[f64], first: usize, last: usize) -> f64 {
    match (lines.get(first), lines.get(last + 1)) {
        (Some(low), Some(high)) => high - low,
        _ => 0.0,
    }
}
