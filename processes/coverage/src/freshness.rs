//! What a robot has not covered yet, and what a leg would cover of it.

#[cfg(test)]
mod tests;

use metrics::coverage::CellGrid;
use nalgebra::Point2;

use crate::space::Space;

/// Cells this much beyond the disc's radius or the free space [m] count, as in the measure of
/// coverage: rounding must not decide.
const TOLERANCE: f64 = 1e-9;

/// The cells of the reachable free space that the disc has not swept in this round.
///
/// A cell counts by its centre. Every fresh cell has a *worth*: 1 among fresh cells, and up to
/// `1 + rarity` the fewer of its neighbours are fresh, because slivers cost the most to come back
/// for. Sums along rows make the worth of a leg cheap: a disc swept along a segment is convex, so
/// that it meets each row of cells in one interval.
#[derive(Debug, Clone, PartialEq)]
pub struct Freshness {
    origin: Point2<f64>,
    side: f64,
    /// Cells per metre.
    per_metre: f64,
    columns: usize,
    rows: usize,
    radius: f64,
    rarity: f64,
    neighbourhood: usize,
    reachable: Vec<bool>,
    total: usize,
    fresh: Vec<bool>,
    left: usize,
    /// Per row `columns + 1` sums of the worth left of a column.
    along_rows: Vec<f32>,
    /// Per column `rows + 1` sums of the worth below a row.
    along_columns: Vec<f32>,
    worth: f64,
    /// Fresh cells left of and above each corner of the grid; kept to reuse its memory.
    corners: Vec<u32>,
}

impl Freshness {
    /// Everything that can be reached is fresh; `radius` [m] of the disc, > 0. The neighbours of a
    /// cell are those up to `neighbourhood` cells away along both axes.
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
            origin: grid.center(0),
            side: grid.side(),
            per_metre: 1.0 / grid.side(),
            columns,
            rows,
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

    /// Makes everything fresh again.
    pub fn renew(&mut self) {
        self.fresh.clone_from(&self.reachable);
        self.left = self.total;
        self.weigh();
    }

    /// Takes over what another one has covered, if its cells are the same.
    pub fn keep_covered(&mut self, before: &Self) {
        let same = self.origin == before.origin
            && self.side == before.side
            && (self.columns, self.rows) == (before.columns, before.rows);
        if !same {
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

    /// Centre of the fresh cell number `index` [m], counted row by row.
    pub fn nth(&self, index: usize) -> Option<Point2<f64>> {
        let mut fresh = self.fresh.iter().enumerate().filter(|&(_, &fresh)| fresh);
        fresh.nth(index).map(|(cell, _)| self.center(cell))
    }

    fn center(&self, cell: usize) -> Point2<f64> {
        let (column, row) = (cell % self.columns, cell / self.columns);
        Point2::new(
            self.origin.x + column as f64 * self.side,
            self.origin.y + row as f64 * self.side,
        )
    }

    /// Worth of what the disc would sweep on the straight leg between two finite points [m²].
    pub fn worth_of(&self, from: Point2<f64>, to: Point2<f64>) -> f64 {
        // Fewer lines of cells cross the leg if they run along it.
        let line = to - from;
        let steep = line.y.abs() > line.x.abs();
        let sums = if steep {
            &self.along_columns
        } else {
            &self.along_rows
        };
        let mut worth = 0.0_f64;
        self.each_span(from, to, steep, |span| {
            let start = span.line * (span.cells + 1);
            let sum = |cell: usize| sums.get(start + cell).copied().unwrap_or(0.0);
            worth += f64::from(sum(span.last + 1) - sum(span.first));
        });
        worth * self.side * self.side
    }

    /// Sweeps the disc along a straight leg between two finite points [m]; returns how many fresh
    /// cells it met.
    pub fn sweep(&mut self, from: Point2<f64>, to: Point2<f64>) -> usize {
        let before = self.left;
        let mut fresh = core::mem::take(&mut self.fresh);
        let mut swept = 0;
        self.each_span(from, to, false, |span| {
            let start = span.line * span.cells;
            let cells = fresh.get_mut(start + span.first..=start + span.last);
            for cell in cells.into_iter().flatten() {
                swept += usize::from(*cell);
                *cell = false;
            }
        });
        self.fresh = fresh;
        self.left = before - swept;
        if swept > 0 {
            self.weigh();
        }
        swept
    }

    /// Fresh cells that the disc would sweep from one place to another [m].
    pub fn fresh_on(&self, from: Point2<f64>, to: Point2<f64>) -> usize {
        let mut found = 0;
        self.each_span(from, to, false, |span| {
            let start = span.line * span.cells;
            let cells = self.fresh.get(start + span.first..=start + span.last);
            found += cells.into_iter().flatten().filter(|cell| **cell).count();
        });
        found
    }

    /// The cells that the disc sweeps, by columns instead of rows on request.
    fn each_span(
        &self,
        from: Point2<f64>,
        to: Point2<f64>,
        by_columns: bool,
        mut visit: impl FnMut(Span),
    ) {
        let (from, to, origin, lines, cells) = if by_columns {
            (
                from.yx(),
                to.yx(),
                self.origin.yx(),
                self.columns,
                self.rows,
            )
        } else {
            (from, to, self.origin, self.rows, self.columns)
        };
        let strip = Strip::new(from, to, self.radius + TOLERANCE);
        let (low, high) = strip.y_range();
        let Some((first, last)) = self.indices(low - origin.y, high - origin.y, lines) else {
            return;
        };
        for line in first..=last {
            let (low, high) = strip.x_range(origin.y + line as f64 * self.side);
            if let Some((first, last)) = self.indices(low - origin.x, high - origin.x, cells) {
                visit(Span {
                    line,
                    cells,
                    first,
                    last,
                });
            }
        }
    }

    /// The cells whose centres lie between two offsets [m] from the first one's, first and last.
    fn indices(&self, low: f64, high: f64, count: usize) -> Option<(usize, usize)> {
        // Casts cut towards 0 and saturate, and cost far less than `floor` and `ceil`.
        let low = low * self.per_metre;
        let cut = low as usize;
        let first = cut + usize::from((cut as f64) < low);
        let behind = (high * self.per_metre + 1.0) as usize;
        let last = behind.min(count).checked_sub(1)?;
        (first <= last).then_some((first, last))
    }

    /// Computes the worth of all cells anew.
    fn weigh(&mut self) {
        let wide = self.columns + 1;
        for row in 0..self.rows {
            let mut run = 0;
            for column in 0..self.columns {
                let cell = row * self.columns + column;
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
        for row in 0..self.rows {
            let (top, bottom) = (row.saturating_sub(reach), (row + reach + 1).min(self.rows));
            let mut sum = 0.0;
            for column in 0..self.columns {
                let mut worth = 0.0;
                if self.fresh.get(row * self.columns + column) == Some(&true) {
                    let left = column.saturating_sub(reach);
                    let right = (column + reach + 1).min(self.columns);
                    let around = corner(bottom, right) - corner(top, right) - corner(bottom, left)
                        + corner(top, left);
                    worth = 1.0 + scale * (most - around);
                    sum += worth;
                }
                if let Some(own) = self.along_rows.get_mut(row * wide + column + 1) {
                    *own = sum as f32;
                }
                let cell = column * (self.rows + 1) + row;
                if let Some([below, own]) = self.along_columns.get_mut(cell..cell + 2) {
                    *own = *below + worth as f32;
                }
            }
            total += sum;
        }
        self.worth = total;
    }
}

/// Cells in a row, or in a column.
struct Span {
    line: usize,
    /// Cells of the whole line.
    cells: usize,
    first: usize,
    last: usize,
}

/// What a disc sweeps on a straight leg.
struct Strip {
    start: Point2<f64>,
    end: Point2<f64>,
    radius: f64,
    length: f64,
    /// Unit vector along the leg.
    along: [f64; 2],
    /// 1 / `along[1]`, finite.
    inverse: f64,
}

impl Strip {
    fn new(start: Point2<f64>, end: Point2<f64>, radius: f64) -> Self {
        let line = end - start;
        let length = line.norm();
        let along = if length > 0.0 {
            [line.x / length, line.y / length]
        } else {
            [1.0, 0.0]
        };
        // A level leg as one that rises too little to matter.
        let level = along[1].abs() < 1e-12;
        let inverse = if level { 1e12 } else { 1.0 / along[1] };
        Self {
            start,
            end,
            radius,
            length,
            along,
            inverse,
        }
    }

    fn y_range(&self) -> (f64, f64) {
        let (a, b) = (self.start.y, self.end.y);
        (a.min(b) - self.radius, a.max(b) + self.radius)
    }

    /// Where the horizontal line at `y` within [`Strip::y_range`] runs through the strip [m].
    fn x_range(&self, y: f64) -> (f64, f64) {
        let [ux, uy] = self.along;
        let half = self.radius * uy.abs();
        let lean = if self.inverse < 0.0 { -ux } else { ux } * self.radius;
        let rise = y - self.start.y;
        // Where along the leg the disc's centre is when its rim meets the line farthest left, and
        // farthest right.
        let (left, right) = ((rise - lean) * self.inverse, (rise + lean) * self.inverse);
        let middle = |part: f64| (0.0..=self.length).contains(&part);
        let low = if middle(left) {
            self.start.x + left * ux - half
        } else {
            let (center, half) = self.at_end(left, y);
            center - half
        };
        let high = if middle(right) {
            self.start.x + right * ux + half
        } else {
            let (center, half) = self.at_end(right, y);
            center + half
        };
        (low, high)
    }

    /// The middle and half the length of the part of the line at `y` in the disc at one end.
    fn at_end(&self, part: f64, y: f64) -> (f64, f64) {
        let end = if part < 0.0 { self.start } else { self.end };
        let rise = y - end.y;
        let square = self.radius * self.radius - rise * rise;
        (end.x, square.max(0.0).sqrt())
    }
}
