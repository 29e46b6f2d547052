//! The vector map of an occupancy grid.

use std::fmt::Write as _;
use std::path::Path;

use geometry::extent::MAX_COORDINATE;
use geometry::grid::{Grid, GridFrame};
use geometry::map::{MAX_OBSTACLES, rectangles};
use geometry::shape::Aabb;
use nalgebra::Point2;

use super::ImportError;
use super::connected::keep_largest;

/// Maximum number of cells of a grid computed from the vector map, if the file's own cells are fewer.
const MAX_CELLS: usize = 4_000_000;
/// Maximum number of cells computed per side of a cell of the file.
const MAX_FACTOR: usize = 4;

/// A world of rectangles.
pub struct World {
    /// Its occupied cells, after removal of unreachable free ones.
    pub occupied: Grid<bool>,
    /// Side of the cells of grids computed from the map (m).
    pub resolution: f64,
    rectangles: Vec<Aabb>,
    free_cells: usize,
}

impl World {
    /// Makes a world of the cells of a file with this side (m).
    ///
    /// # Errors
    /// No free cell, too many rectangles, or too large.
    pub fn of_cells(path: &Path, grid: Grid<bool>, side: f64) -> Result<Self, ImportError> {
        let frame = GridFrame {
            resolution: side,
            ..grid.frame
        };
        let factor = (1..=MAX_FACTOR)
            .rev()
            .find(|factor| frame.len() * factor * factor <= MAX_CELLS);
        let resolution = side / factor.unwrap_or(1) as f64;
        Self::new(path, Grid { frame, ..grid }, resolution)
    }

    /// As [`World::of_cells`], with the side of the cells of computed grids (m).
    pub fn new(
        path: &Path,
        mut occupied: Grid<bool>,
        resolution: f64,
    ) -> Result<Self, ImportError> {
        let frame = occupied.frame;
        let extent = frame.width.max(frame.height) as f64 * frame.resolution;
        if !(frame.resolution > 0.0 && extent <= MAX_COORDINATE) {
            let found = format!("a world of {extent} m");
            let expected = format!("a size > 0 and ≤ {MAX_COORDINATE} m");
            return Err(ImportError::content(path, found, expected));
        }
        let free_cells = keep_largest(&mut occupied);
        if free_cells == 0 {
            return Err(ImportError::content(path, "no free cell", "free space"));
        }
        let rectangles = rectangles(&occupied);
        if rectangles.len() > MAX_OBSTACLES {
            let found = format!("{} rectangles", rectangles.len());
            let expected = format!("at most {MAX_OBSTACLES}: a smaller part");
            return Err(ImportError::content(path, found, expected));
        }
        Ok(Self {
            occupied,
            resolution,
            rectangles,
            free_cells,
        })
    }

    /// Returns the area of the free space (m²).
    pub fn free_area(&self) -> f64 {
        self.free_cells as f64 * self.occupied.frame.resolution.powi(2)
    }

    /// Returns the smallest and largest corner (m).
    pub fn corners(&self) -> [Point2<f64>; 2] {
        let frame = self.occupied.frame;
        let size = [frame.width, frame.height].map(|cells| cells as f64 * frame.resolution);
        [frame.origin, frame.origin + nalgebra::Vector2::from(size)]
    }

    /// Returns the place (m) that is nearest to the smallest corner among the centres of free cells from which no
    /// occupied cell is nearer than this (m), if there is one.
    pub fn place_in_corner(&self, clearance: f64) -> Option<Point2<f64>> {
        let frame = self.occupied.frame;
        // From a centre, its own cell reaches half a cell.
        let around = (clearance / frame.resolution - 0.5).ceil().max(0.0) as usize;
        let is_clear = |column: usize, row: usize| {
            let [left, bottom] = [column.checked_sub(around), row.checked_sub(around)];
            let (Some(left), Some(bottom)) = (left, bottom) else {
                return false;
            };
            let (right, top) = (column + around, row + around);
            let mut cells = (bottom..=top).flat_map(|row| {
                let row = (right < frame.width && top < frame.height).then_some(row);
                (left..=right).map(move |column| row.map(|row| frame.index(column, row)))
            });
            cells.all(|cell| cell.is_some_and(|cell| self.occupied.cells.get(cell) == Some(&false)))
        };
        let mut nearest: Option<(usize, [usize; 2])> = None;
        for row in 0..frame.height {
            for column in 0..frame.width {
                let away = column * column + row * row;
                if nearest.is_none_or(|(least, _)| away < least) && is_clear(column, row) {
                    nearest = Some((away, [column, row]));
                }
            }
        }
        nearest.map(|(_, [column, row])| frame.center(column, row))
    }

    /// Returns the map as TOML.
    pub fn toml(&self, name: &str) -> String {
        let [min, max] = self.corners();
        let mut text = format!(
            "name = \"{name}\"\nbounds = {{ min = [{:?}, {:?}], max = [{:?}, {:?}] }}  # [m]\n\
             resolution = {:?}  # [m]\nobstacles = [\n",
            min.x, min.y, max.x, max.y, self.resolution
        );
        for Aabb { min, max } in &self.rectangles {
            let (center, half) = (nalgebra::center(min, max), 0.5 * (max - min));
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "  {{ shape.rectangle = {{ center = [{:?}, {:?}], half_extents = [{:?}, {:?}] }} }},",
                center.x, center.y, half.x, half.y
            );
        }
        text.push_str("]\n");
        text
    }
}
