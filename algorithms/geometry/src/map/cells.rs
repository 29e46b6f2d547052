//! Maps given as occupancy grids.

use nalgebra::Point2;
use parameters::{Parameters, ParamsError, check, each, require};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{MAX_CELLS, MAX_EXITS};
use crate::extent::{MAX_COORDINATE, coordinate, positive};
use crate::grid::{Grid, GridFrame};
use crate::region::Region;
use crate::shape::Aabb;

/// Maximum number of runs of a map; a scenario in a log has room for this many.
pub const MAX_RUNS: usize = 1_000_000;

parameters::choice! {
    /// Meaning of the unknown cells of an occupancy map.
    pub enum UnknownCells {
        /// Obstacles: robots do not drive into unexplored cells.
        #[default]
        Occupied,
        /// Free space.
        Free,
    }
}

/// Occupancy of a cell of an occupancy map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Occupancy {
    /// Free space.
    Free,
    /// An obstacle.
    Occupied,
    /// Not known.
    Unknown,
}

/// An occupancy grid as run lengths. Cells are counted row by row from the one with the smallest x
/// and y; the edge of the grid is a wall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CellMap {
    /// Number of columns (cells along x).
    pub width: usize,
    /// Number of rows (cells along y).
    pub height: usize,
    /// Side of a cell.
    #[schemars(transform = positive("m"))]
    pub resolution: f64,
    /// Outer corner of the first cell, x and y.
    #[schemars(transform = each(coordinate()))]
    pub origin: [f64; 2],
    /// Lengths of the runs of equal cells, alternately free and occupied, the first one free (0 if
    /// the first cell is occupied); their sum is the number of cells.
    #[schemars(length(max = MAX_RUNS))]
    pub runs: Vec<usize>,
    /// Exits for evaders.
    #[serde(default)]
    #[schemars(length(max = MAX_EXITS))]
    pub exits: Vec<Region>,
}

impl Parameters for CellMap {}

impl CellMap {
    /// Converts an occupancy grid (`true` is occupied).
    ///
    /// ```
    /// use geometry::grid::{Grid, GridFrame};
    /// use geometry::map::CellMap;
    /// use nalgebra::Point2;
    ///
    /// let frame = GridFrame { width: 3, height: 2, resolution: 0.5, origin: Point2::origin() };
    /// let mut occupied = Grid::filled(frame, false);
    /// occupied.cells[frame.index(1, 0)] = true;
    /// let map = CellMap::from_grid(&occupied);
    /// assert_eq!(map.runs, [1, 1, 4]);
    /// assert_eq!(map.to_grid()?, occupied);
    /// # Ok::<(), parameters::ParamsError>(())
    /// ```
    pub fn from_grid(grid: &Grid<bool>) -> Self {
        let mut runs = vec![0];
        let mut current = false;
        for &cell in &grid.cells {
            if cell != current {
                runs.push(0);
                current = cell;
            }
            if let Some(run) = runs.last_mut() {
                *run += 1;
            }
        }
        let GridFrame {
            width,
            height,
            resolution,
            origin,
        } = grid.frame;
        Self {
            width,
            height,
            resolution,
            origin: [origin.x, origin.y],
            runs,
            exits: Vec::new(),
        }
    }

    /// Converts an occupancy map, whose unknown cells have this meaning.
    pub fn from_occupancy(map: &Grid<Occupancy>, unknown: UnknownCells) -> Self {
        let cells = map.cells.iter().map(|cell| match cell {
            Occupancy::Free => false,
            Occupancy::Occupied => true,
            Occupancy::Unknown => unknown == UnknownCells::Occupied,
        });
        Self::from_grid(&Grid {
            frame: map.frame,
            cells: cells.collect(),
        })
    }

    /// Checks every field.
    ///
    /// # Errors
    /// The error names the first field that is out of its range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        let cells = self.width.saturating_mul(self.height);
        require(
            (1..=MAX_CELLS).contains(&cells),
            "width × height",
            &format!("{} × {}", self.width, self.height),
            format!("1 to {MAX_CELLS} cells"),
        )?;
        // The many runs are checked below.
        check(&Self {
            runs: Vec::new(),
            exits: self.exits.clone(),
            ..*self
        })?;
        for (axis, count) in [self.width, self.height].into_iter().enumerate() {
            let far = self.origin[axis] + count as f64 * self.resolution;
            require(
                far.abs() <= MAX_COORDINATE,
                &format!("origin[{axis}] + cells · resolution"),
                &far,
                format!("a number within ±{MAX_COORDINATE} (m)"),
            )?;
        }
        require(
            self.runs.len() <= MAX_RUNS,
            "runs",
            &format!("{} runs", self.runs.len()),
            format!("at most {MAX_RUNS}: less noise in the map"),
        )?;
        let sum = self
            .runs
            .iter()
            .try_fold(0usize, |sum, &run| sum.checked_add(run));
        require(
            sum == Some(cells),
            "runs",
            &sum.map_or_else(
                || "an overflowing sum".to_owned(),
                |s| format!("a sum of {s}"),
            ),
            format!("run lengths that add up to width × height = {cells}"),
        )
    }

    /// Frame of the cells.
    pub fn frame(&self) -> GridFrame {
        GridFrame {
            width: self.width,
            height: self.height,
            resolution: self.resolution,
            origin: Point2::new(self.origin[0], self.origin[1]),
        }
    }

    /// The occupancy grid (`true` is occupied).
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn to_grid(&self) -> Result<Grid<bool>, ParamsError> {
        self.validate()?;
        let mut cells = Vec::with_capacity(self.width * self.height);
        let mut occupied = false;
        for &run in &self.runs {
            cells.resize(cells.len() + run, occupied);
            occupied = !occupied;
        }
        Ok(Grid {
            frame: self.frame(),
            cells,
        })
    }
}

/// Rectangles that together cover exactly the occupied cells: each takes the longest remaining run
/// of a row and as many following rows as contain the whole run.
///
/// Corners on the same cell border have the same bits, so that adjacent rectangles leave no gap.
pub fn rectangles(grid: &Grid<bool>) -> Vec<Aabb> {
    let GridFrame {
        width,
        height,
        resolution,
        origin,
    } = grid.frame;
    let at = |col: usize, row: usize| {
        Point2::new(
            origin.x + col as f64 * resolution,
            origin.y + row as f64 * resolution,
        )
    };
    let mut left = grid.cells.clone();
    let mut found = Vec::new();
    for row in 0..height {
        let mut col = 0;
        while col < width {
            if !left[row * width + col] {
                col += 1;
                continue;
            }
            let run = left[row * width + col..(row + 1) * width]
                .iter()
                .take_while(|&&o| o)
                .count();
            let mut end = row;
            while end < height
                && left[end * width + col..end * width + col + run]
                    .iter()
                    .all(|&o| o)
            {
                left[end * width + col..end * width + col + run].fill(false);
                end += 1;
            }
            found.push(Aabb {
                min: at(col, row),
                max: at(col + run, end),
            });
            col += run;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn grid(width: usize, height: usize, cells: Vec<bool>) -> Grid<bool> {
        let frame = GridFrame {
            width,
            height,
            resolution: 0.1,
            origin: Point2::new(-1.0, 2.0),
        };
        Grid { frame, cells }
    }

    #[test]
    fn a_block_is_one_rectangle() {
        let mut g = grid(5, 4, vec![false; 20]);
        for (col, row) in [(1, 1), (2, 1), (1, 2), (2, 2)] {
            g.cells[row * 5 + col] = true;
        }
        let found = rectangles(&g);
        assert_eq!(found.len(), 1);
        assert!((found[0].min - Point2::new(-0.9, 2.1)).norm() < 1e-12);
        assert!((found[0].max - Point2::new(-0.7, 2.3)).norm() < 1e-12);
    }

    #[test]
    fn wrong_runs_and_sizes_are_named() {
        let mut map = CellMap::from_grid(&grid(2, 2, vec![true, false, false, true]));
        assert_eq!(map.runs, [0, 1, 2, 1]);
        map.runs.push(7);
        assert!(
            map.validate()
                .unwrap_err()
                .to_string()
                .starts_with("`runs` is a sum of 11")
        );
        map.runs = vec![usize::MAX, 2];
        assert!(map.validate().is_err());
        map.width = usize::MAX;
        assert!(map.validate().unwrap_err().to_string().contains("cells"));
    }

    proptest! {
        #[test]
        fn rectangles_cover_the_occupied_cells_once(
            cells in proptest::collection::vec(any::<bool>(), 7 * 6),
        ) {
            let g = grid(7, 6, cells);
            let found = rectangles(&g);
            for row in 0..6 {
                for col in 0..7 {
                    let p = g.frame.center(col, row);
                    let covers = found.iter().filter(|r| r.contains(p)).count();
                    prop_assert_eq!(covers, usize::from(g.cells[row * 7 + col]));
                }
            }
            prop_assert_eq!(CellMap::from_grid(&g).to_grid().unwrap(), g);
        }
    }
}
