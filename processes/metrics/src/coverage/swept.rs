//! Which cells a disc has swept.

use nalgebra::Point2;

use super::{CellGrid, TOLERANCE};

/// Cells whose centres came within a radius of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct Swept {
    grid: CellGrid,
    radius: f64,
    reached: Vec<bool>,
    covered: usize,
}

impl Swept {
    /// Nothing swept yet by a disc of `radius` [m].
    pub fn new(grid: CellGrid, radius: f64) -> Self {
        Self {
            reached: vec![false; grid.len()],
            grid,
            radius,
            covered: 0,
        }
    }

    /// The cells.
    pub fn grid(&self) -> &CellGrid {
        &self.grid
    }

    /// Sweeps the disc straight from one point to another [m]; does nothing for points that are
    /// not finite.
    pub fn sweep(&mut self, from: Point2<f64>, to: Point2<f64>) {
        let reach = self.radius + TOLERANCE;
        let origin = self.grid.center(0);
        let side = self.grid.side();
        let Some(rows) = between(
            (from.y.min(to.y) - reach - origin.y) / side,
            (from.y.max(to.y) + reach - origin.y) / side,
            self.grid.rows(),
        ) else {
            return;
        };
        for row in rows {
            let y = origin.y + row as f64 * side;
            // Only the part of the segment that is within reach of the row can reach its cells.
            let Some((first, last)) = part_within(from, to, y - reach, y + reach) else {
                continue;
            };
            let Some(columns) = between(
                (first.x.min(last.x) - reach - origin.x) / side,
                (first.x.max(last.x) + reach - origin.x) / side,
                self.grid.columns(),
            ) else {
                continue;
            };
            for column in columns {
                let cell = row * self.grid.columns() + column;
                let center = Point2::new(origin.x + column as f64 * side, y);
                let Some(reached) = self.reached.get_mut(cell) else {
                    continue;
                };
                if !*reached && distance_squared(center, from, to) <= reach * reach {
                    *reached = true;
                    self.covered += usize::from(self.grid.is_coverable(cell));
                }
            }
        }
    }

    /// Per cell whether its centre has been swept.
    pub fn cells(&self) -> &[bool] {
        &self.reached
    }

    /// Coverable cells that have been swept.
    pub fn covered(&self) -> usize {
        self.covered
    }

    /// The coverage rate C, from 0 to 1.
    pub fn rate(&self) -> f64 {
        self.covered as f64 / self.grid.coverable() as f64
    }
}

/// The whole numbers from `low` to `high` that are below `count`; `None` if there is none.
fn between(low: f64, high: f64, count: usize) -> Option<core::ops::RangeInclusive<usize>> {
    let sound = low.is_finite() && high >= 0.0 && low <= (count - 1) as f64;
    let (first, last) = (low.ceil().max(0.0), high.floor().min((count - 1) as f64));
    (sound && first <= last).then_some(first as usize..=last as usize)
}

/// The ends of the part of a segment whose y lies between two values.
fn part_within(
    from: Point2<f64>,
    to: Point2<f64>,
    low: f64,
    high: f64,
) -> Option<(Point2<f64>, Point2<f64>)> {
    let rise = to.y - from.y;
    if rise == 0.0 {
        return (from.y >= low && from.y <= high).then_some((from, to));
    }
    let (a, b) = ((low - from.y) / rise, (high - from.y) / rise);
    let (enter, exit) = (a.min(b).max(0.0), a.max(b).min(1.0));
    (enter <= exit).then(|| (from + (to - from) * enter, from + (to - from) * exit))
}

/// Square of the distance between a point and a segment.
fn distance_squared(p: Point2<f64>, from: Point2<f64>, to: Point2<f64>) -> f64 {
    let (line, offset) = (to - from, p - from);
    let length_squared = line.norm_squared();
    let part = if length_squared > 0.0 {
        (offset.dot(&line) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (offset - line * part).norm_squared()
}
