//! The cells that a disc sweeps on a straight leg.
//!
//! A disc swept along a segment is convex, so that it meets each row, and each column, of cells in
//! one interval.

use nalgebra::Point2;

use super::TOLERANCE;

/// The centres of square cells, row after row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    /// Centre of the first cell (m).
    origin: Point2<f64>,
    side: f64,
    /// Cells per metre.
    per_metre: f64,
    columns: usize,
    rows: usize,
}

/// Orientation of the lines of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Rows, along x.
    Rows,
    /// Columns, along y.
    Columns,
}

/// Consecutive cells of a row or of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// The row or the column.
    pub line: usize,
    /// Number of cells of the whole line.
    pub cells: usize,
    /// The first of the cells.
    pub first: usize,
    /// The last of the cells.
    pub last: usize,
}

impl Lattice {
    /// Creates cells of this side (m) from the centre of the first (m) and the numbers of columns
    /// and rows.
    pub fn new(origin: Point2<f64>, side: f64, [columns, rows]: [usize; 2]) -> Self {
        Self {
            origin,
            side,
            per_metre: 1.0 / side,
            columns,
            rows,
        }
    }

    /// Side of the cells (m).
    pub fn side(&self) -> f64 {
        self.side
    }

    /// Columns, along x.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Rows, along y.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Centre of a cell (m).
    pub fn center(&self, cell: usize) -> Point2<f64> {
        let (column, row) = (cell % self.columns, cell / self.columns);
        Point2::new(
            self.origin.x + column as f64 * self.side,
            self.origin.y + row as f64 * self.side,
        )
    }

    /// Visits the cells whose centres come within `radius` (m) of the segment between two points
    /// (m), line by line. Both points must be finite.
    pub fn each_span(
        &self,
        from: Point2<f64>,
        to: Point2<f64>,
        radius: f64,
        axis: Axis,
        mut visit: impl FnMut(Span),
    ) {
        let (columns, rows) = (self.columns, self.rows);
        let (from, to, origin, lines, cells) = match axis {
            Axis::Rows => (from, to, self.origin, rows, columns),
            Axis::Columns => (from.yx(), to.yx(), self.origin.yx(), columns, rows),
        };
        let strip = Strip::new(from, to, radius + TOLERANCE);
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

    /// The first and last cell whose centres lie between two offsets (m) from the first centre.
    fn indices(&self, low: f64, high: f64, count: usize) -> Option<(usize, usize)> {
        // Casts truncate towards 0 and saturate, and cost far less than `floor` and `ceil`.
        let low = low * self.per_metre;
        let cut = low as usize;
        let first = cut + usize::from((cut as f64) < low);
        let behind = (high * self.per_metre + 1.0) as usize;
        let last = behind.min(count).checked_sub(1)?;
        (first <= last).then_some((first, last))
    }
}

/// The area that a disc sweeps on a straight leg.
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
        // A level leg is treated as one with a negligible slope.
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

    /// The range of x of the strip on the horizontal line at `y` within [`Strip::y_range`] (m).
    fn x_range(&self, y: f64) -> (f64, f64) {
        let [ux, uy] = self.along;
        let half = self.radius * uy.abs();
        let lean = if self.inverse < 0.0 { -ux } else { ux } * self.radius;
        let rise = y - self.start.y;
        // Positions of the disc's centre along the leg at which its rim meets the line farthest
        // left, and farthest right.
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

    /// The middle and half the length of the line at `y` inside the disc at one end.
    fn at_end(&self, part: f64, y: f64) -> (f64, f64) {
        let end = if part < 0.0 { self.start } else { self.end };
        let rise = y - end.y;
        let square = self.radius * self.radius - rise * rise;
        (end.x, square.max(0.0).sqrt())
    }
}
