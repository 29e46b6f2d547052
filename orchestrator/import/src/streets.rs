//! Streets as free corridors between blocks.

use std::path::Path;

use geometry::grid::{Grid, GridFrame};
use nalgebra::Point2;

use super::ImportError;
use super::project::extent;
use super::vectors::World;

/// Maximum number of cells.
const MAX_CELLS: f64 = 4e6;
/// Number of cells across a street, if the world is not too large for it.
const ACROSS: f64 = 8.0;
/// Minimum number of cells across a street.
const MIN_ACROSS: f64 = 3.0;

/// A street graph in the plane.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Streets {
    /// Straight pieces of streets by their ends (m).
    pub pieces: Vec<[[f64; 2]; 2]>,
}

impl Streets {
    /// Adds the street along these points.
    pub fn add(&mut self, points: &[[f64; 2]]) {
        let pairs = points.iter().zip(points.iter().skip(1));
        self.pieces.extend(pairs.map(|(&from, &to)| [from, to]));
    }

    /// Adds the street between two nodes along lines. The source is joined to the nearest end of a line, the target to
    /// the nearest of the other ends; directions and order of the lines are of no effect.
    pub fn add_edge(&mut self, source: [f64; 2], target: [f64; 2], lines: &[Vec<[f64; 2]>]) {
        let mut ends: Vec<[f64; 2]> = Vec::new();
        for line in lines {
            self.add(line);
            ends.extend(line.first().into_iter().chain(line.last()));
        }
        for node in [source, target] {
            let distance = |end: &[f64; 2]| (Point2::from(*end) - Point2::from(node)).norm();
            let near = ends.iter().map(distance).enumerate();
            if let Some((nearest, _)) = near.min_by(|a, b| a.1.total_cmp(&b.1)) {
                self.add(&[node, ends.swap_remove(nearest)]);
            }
        }
    }

    /// Makes a world in which the streets with this width (m) are free and all else is occupied.
    ///
    /// # Errors
    /// No street, or a world with too many cells.
    pub fn world(&self, path: &Path, width: f64) -> Result<World, ImportError> {
        let ends = self.pieces.as_flattened();
        let Some([min, max]) = extent(ends) else {
            return Err(ImportError::content(path, "no street", "at least one"));
        };
        if !ends.iter().flatten().all(|c| c.is_finite()) {
            return Err(ImportError::content(path, "a place at infinity", "numbers"));
        }
        let longest = (max[0] - min[0]).max(max[1] - min[1]);
        if longest < width {
            let found = format!("streets within {longest:.3} m × {longest:.3} m");
            let expected = format!("metres, or the `crs` of degrees, and more than {width} m");
            return Err(ImportError::content(path, found, expected));
        }
        let border = 0.5 * width;
        let [w, h] = [0, 1].map(|i| max[i] - min[i] + 2.0 * border);
        let side = (width / ACROSS).max((w * h / MAX_CELLS).sqrt());
        if side * MIN_ACROSS > width {
            let found = format!("streets on {:.1} km × {:.1} km", w / 1e3, h / 1e3);
            let expected = format!("a smaller part, or streets wider than {width} m");
            return Err(ImportError::content(path, found, expected));
        }
        let frame = GridFrame {
            width: (w / side).ceil() as usize,
            height: (h / side).ceil() as usize,
            resolution: side,
            origin: Point2::new(min[0] - border, min[1] - border),
        };
        let mut occupied = Grid::filled(frame, true);
        for &[from, to] in &self.pieces {
            // Rounding must not tell a street from its reverse.
            let (from, to) = if to < from { (to, from) } else { (from, to) };
            clear(&mut occupied, from.into(), to.into(), 0.5 * width);
        }
        World::new(path, occupied, side)
    }
}

/// Frees the cells whose centres are at most this far from a segment (m).
fn clear(occupied: &mut Grid<bool>, from: Point2<f64>, to: Point2<f64>, reach: f64) {
    let frame = occupied.frame;
    let along = to - from;
    let squared = along.norm_squared();
    let index =
        |v: f64, count: usize| (v / frame.resolution).clamp(0.0, count as f64 - 1.0) as usize;
    let rows = [from.y.min(to.y) - reach, from.y.max(to.y) + reach]
        .map(|y| index(y - frame.origin.y, frame.height));
    for row in rows[0]..=rows[1] {
        // The part of the segment that is not too far below or above the row.
        let y = frame.center(0, row).y;
        let part = [y - reach, y + reach].map(|y| {
            let share = (y - from.y) / along.y;
            if share.is_finite() {
                share.clamp(0.0, 1.0)
            } else {
                f64::NAN
            }
        });
        let [low, high] = if part.iter().any(|share| share.is_nan()) {
            [from.x, to.x]
        } else {
            part.map(|share| from.x + share * along.x)
        };
        let columns = [low.min(high) - reach, low.max(high) + reach]
            .map(|x| index(x - frame.origin.x, frame.width));
        for column in columns[0]..=columns[1] {
            let center = frame.center(column, row);
            let share = if squared > 0.0 {
                ((center - from).dot(&along) / squared).clamp(0.0, 1.0)
            } else {
                0.0
            };
            if (from + share * along - center).norm() <= reach
                && let Some(cell) = occupied.cells.get_mut(frame.index(column, row))
            {
                *cell = false;
            }
        }
    }
}
