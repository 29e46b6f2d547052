//! Regular grids of square cells laid over the world.

use nalgebra::Point2;
use serde::{Deserialize, Serialize};

/// Placement of a grid of square cells in the world frame.
///
/// Cell (column 0, row 0) is the one with the smallest x and y; columns run along +x, rows along
/// +y; cells are stored row by row (`index = row * width + column`).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GridFrame {
    /// Number of columns (cells along x).
    pub width: usize,
    /// Number of rows (cells along y).
    pub height: usize,
    /// Side of a cell (m), > 0.
    pub resolution: f64,
    /// World position of the *outer corner* of cell (0, 0) (m).
    pub origin: Point2<f64>,
}

impl GridFrame {
    /// Number of cells.
    pub fn len(&self) -> usize {
        self.width * self.height
    }

    /// Returns `true` if the grid has no cells.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The cell (column, row) that contains a world point (m); `None` outside the grid or for a
    /// non-finite point.
    pub fn cell_at(&self, p: Point2<f64>) -> Option<(usize, usize)> {
        // Truncation rounds down here and, unlike `floor`, needs no call on the oldest x86-64.
        let col = (p.x - self.origin.x) / self.resolution;
        let row = (p.y - self.origin.y) / self.resolution;
        let inside =
            col >= 0.0 && row >= 0.0 && col < self.width as f64 && row < self.height as f64;
        inside.then_some((col as usize, row as usize))
    }

    /// Storage index of a cell.
    pub fn index(&self, col: usize, row: usize) -> usize {
        row * self.width + col
    }

    /// Storage index of the cell that contains a world point (m).
    pub fn index_at(&self, p: Point2<f64>) -> Option<usize> {
        self.cell_at(p).map(|(col, row)| self.index(col, row))
    }

    /// World position of a cell's centre (m).
    pub fn center(&self, col: usize, row: usize) -> Point2<f64> {
        Point2::new(
            self.origin.x + (col as f64 + 0.5) * self.resolution,
            self.origin.y + (row as f64 + 0.5) * self.resolution,
        )
    }
}

/// A value per cell of a [`GridFrame`].
///
/// ```
/// use geometry::grid::{Grid, GridFrame};
/// use nalgebra::Point2;
///
/// let frame = GridFrame { width: 4, height: 3, resolution: 0.5, origin: Point2::new(-1.0, 0.0) };
/// let mut visits = Grid::filled(frame, 0);
/// visits.cells[frame.index(2, 1)] += 1;
/// assert_eq!(visits.at(Point2::new(0.2, 0.7)), Some(&1));
/// assert_eq!(visits.at(Point2::new(5.0, 0.0)), None);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Grid<T> {
    /// Frame of the cells.
    pub frame: GridFrame,
    /// The values, row by row; `cells.len() == frame.len()`.
    pub cells: Vec<T>,
}

impl<T: Clone> Grid<T> {
    /// A grid with the same value in every cell.
    pub fn filled(frame: GridFrame, value: T) -> Self {
        Self {
            frame,
            cells: vec![value; frame.len()],
        }
    }
}

impl<T> Grid<T> {
    /// The value of the cell that contains a world point (m).
    pub fn at(&self, p: Point2<f64>) -> Option<&T> {
        self.frame.index_at(p).map(|i| &self.cells[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_half_open_and_centres_map_back() {
        let frame = GridFrame {
            width: 4,
            height: 3,
            resolution: 0.5,
            origin: Point2::new(-1.0, 2.0),
        };
        for row in 0..frame.height {
            for col in 0..frame.width {
                assert_eq!(frame.cell_at(frame.center(col, row)), Some((col, row)));
            }
        }
        assert_eq!(frame.cell_at(Point2::new(-1.0, 2.0)), Some((0, 0)));
        assert_eq!(frame.cell_at(Point2::new(1.0, 2.0)), None);
        assert_eq!(frame.cell_at(Point2::new(f64::NAN, 2.0)), None);
    }
}
