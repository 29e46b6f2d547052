//! The static scene: walls, obstacles, exits.

use std::collections::BTreeMap;

use geometry::map::{MapSpec, ObstacleChange};
use geometry::math;
use geometry::region::Region;
use geometry::shape::Shape;
use ipc_types::messages::world::{MapCell, MapHeader};

/// Maximum number of corners of all obstacles of a vector map that is drawn as vectors.
const MAX_CORNERS: usize = 2500;
/// Maximum number of cells per side of the grid that is drawn of any other map.
const MAX_CELLS: usize = 1024;
/// Maximum number of rectangles of such a grid.
const MAX_RECTANGLES: usize = 2500;

/// The static scene: walls, obstacles, exits.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StaticScene {
    /// Smallest x and y of the world (m).
    pub min: [f64; 2],
    /// Largest x and y of the world (m).
    pub max: [f64; 2],
    /// Obstacles with a shape, by their number in the world.
    pub obstacles: BTreeMap<u32, StaticObstacle>,
    /// The occupied cells of a map that is not drawn as vectors.
    pub cells: Option<Cells>,
    /// Exits of the evaders.
    pub exits: Vec<Region>,
    /// Number of obstacles of the map, whose numbers are the first.
    pub(crate) own: u32,
}

/// An obstacle with a shape.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticObstacle {
    /// Shape and position.
    pub shape: Shape,
    /// `true` if the obstacle was added or moved during the run.
    pub came: bool,
}

/// An occupancy grid.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cells {
    /// Outer corner of cell (0, 0), x and y (m).
    pub origin: [f64; 2],
    /// Side of a cell (m).
    pub side: f64,
    /// Number of columns.
    pub width: usize,
    /// Row by row from the smallest y, columns along +x.
    pub occupied: Vec<bool>,
}

impl StaticScene {
    /// Builds the static scene of a scenario's map, if the map consists of shapes.
    pub(crate) fn from_map(map: &MapSpec, exits: &[Region]) -> Self {
        let map = match map {
            MapSpec::Vector(map) => map,
            MapSpec::Cells(map) => {
                return Self {
                    exits: map.exits.iter().chain(exits).copied().collect(),
                    ..Self::default()
                };
            }
            // A log contains its map inline.
            MapSpec::File { .. } => {
                return Self {
                    exits: exits.to_vec(),
                    ..Self::default()
                };
            }
        };
        let corners: usize = map.obstacles.iter().map(|o| corner_count(&o.shape)).sum();
        let obstacles = if corners > MAX_CORNERS {
            BTreeMap::new()
        } else {
            // The index of an obstacle in the world is its index in the map.
            let numbered = (0_u32..).zip(&map.obstacles);
            numbered
                .map(|(id, obstacle)| {
                    let shape = obstacle.shape.clone();
                    (id, StaticObstacle { shape, came: false })
                })
                .collect()
        };
        Self {
            min: map.bounds.min,
            max: map.bounds.max,
            obstacles,
            cells: None,
            own: map.obstacles.len() as u32,
            exits: map.exits.iter().chain(exits).copied().collect(),
        }
    }

    /// Returns `true` if the walls are vectors.
    pub(crate) fn has_vectors(&self) -> bool {
        !self.obstacles.is_empty()
    }

    /// Returns `true` if there are walls or obstacles.
    pub(crate) fn has_walls(&self) -> bool {
        let occupied = self.cells.iter().flat_map(|cells| &cells.occupied);
        self.has_vectors() || occupied.into_iter().any(|&cell| cell)
    }

    /// Applies a change of the obstacles.
    pub(crate) fn apply(&mut self, change: ObstacleChange) {
        match change {
            ObstacleChange::Appear { id, shape } | ObstacleChange::Move { id, shape } => {
                self.obstacles
                    .insert(id.0, StaticObstacle { shape, came: true });
            }
            ObstacleChange::Disappear { id } => {
                self.obstacles.remove(&id.0);
            }
        }
    }

    /// Takes the walls from a map message; does nothing if its dimensions are inconsistent.
    pub(crate) fn use_cells(&mut self, header: &MapHeader, cells: &[MapCell]) {
        let (side, width) = (header.resolution, header.width as usize);
        let origin = [header.origin_x, header.origin_y];
        if is_grid(cells.len(), width, header.height, side, origin) {
            let occupied = cells.iter().map(|cell| cell.occupied != 0).collect();
            self.set_cells(Cells {
                origin,
                side,
                width,
                occupied,
            });
        }
    }

    /// Sets the walls and the bounds to those of a grid.
    pub(crate) fn set_cells(&mut self, fine: Cells) {
        let (width, side) = (fine.width.max(1), fine.side);
        let height = fine.occupied.len() / width;
        self.min = fine.origin;
        self.max = [
            fine.origin[0] + width as f64 * side,
            fine.origin[1] + height as f64 * side,
        ];
        let factor = width.max(height).div_ceil(MAX_CELLS);
        self.cells = Some(if factor > 1 {
            fine.coarser(factor)
        } else {
            fine
        });
    }
}

impl Cells {
    /// Returns the grid with `factor` × `factor` cells joined into one, occupied if any of them is.
    fn coarser(&self, factor: usize) -> Self {
        let width = self.width.div_ceil(factor);
        let height = (self.occupied.len() / self.width.max(1)).div_ceil(factor);
        let mut occupied = vec![false; width * height];
        for (row, cells) in self.occupied.chunks(self.width.max(1)).enumerate() {
            for (column, _) in cells.iter().enumerate().filter(|&(_, &cell)| cell) {
                if let Some(joint) = occupied.get_mut(row / factor * width + column / factor) {
                    *joint = true;
                }
            }
        }
        Self {
            origin: self.origin,
            side: self.side * factor as f64,
            width,
            occupied,
        }
    }

    /// Returns rectangles (smallest and largest corner (m)) that cover the occupied cells. A grid
    /// that needs too many rectangles is made coarser first.
    pub(crate) fn rectangles(&self) -> Vec<[[f64; 2]; 2]> {
        self.at_most(MAX_RECTANGLES)
    }

    /// Like [`Cells::rectangles`], with at most `most` rectangles.
    pub(crate) fn at_most(&self, most: usize) -> Vec<[[f64; 2]; 2]> {
        let mut rectangles = self.runs();
        let mut factor = 2;
        while rectangles.len() > most.max(1) {
            rectangles = self.coarser(factor).runs();
            factor += 1;
        }
        rectangles
    }

    /// Runs of occupied cells along the rows; equal runs of neighbouring rows are joined.
    fn runs(&self) -> Vec<[[f64; 2]; 2]> {
        let mut done = Vec::new();
        // Runs that reach the previous row, by first and last column: the row in which they begin.
        let mut open: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        let rows = self.occupied.chunks(self.width.max(1));
        let height = rows.len();
        let mut close = |run: (usize, usize), from: usize, to: usize| {
            let x = |column: usize| self.origin[0] + column as f64 * self.side;
            let y = |row: usize| self.origin[1] + row as f64 * self.side;
            done.push([[x(run.0), y(from)], [x(run.1 + 1), y(to)]]);
        };
        for (row, cells) in rows.enumerate() {
            let mut now = BTreeMap::new();
            let mut start = None;
            for column in 0..=cells.len() {
                let occupied = cells.get(column).copied().unwrap_or(false);
                match (start, occupied) {
                    (None, true) => start = Some(column),
                    (Some(first), false) => {
                        let run = (first, column - 1);
                        now.insert(run, open.remove(&run).unwrap_or(row));
                        start = None;
                    }
                    _ => {}
                }
            }
            for (run, from) in core::mem::replace(&mut open, now) {
                close(run, from, row);
            }
        }
        for (run, from) in open {
            close(run, from, height);
        }
        done
    }
}

/// Returns `true` if a grid from a log has this number of cells, and is in a possible place: the side of a cell and the corner (m).
pub fn is_grid(cells: usize, width: usize, height: u32, side: f64, origin: [f64; 2]) -> bool {
    let is_whole = width > 0 && width.checked_mul(height as usize) == Some(cells);
    is_whole && side > 0.0 && side <= 1e5 && origin.iter().all(|c| c.abs() <= 1e7)
}

/// Returns the corners of a shape (m), counter-clockwise (SVG leaves holes where shapes of opposite
/// orientation overlap); none for a circle.
pub fn corners(shape: &Shape) -> Vec<[f64; 2]> {
    match shape {
        Shape::Circle { .. } => Vec::new(),
        Shape::Polygon { vertices } => {
            let next = vertices.iter().cycle().skip(1);
            let area: f64 = vertices
                .iter()
                .zip(next)
                .map(|(a, b)| a[0] * b[1] - b[0] * a[1])
                .sum();
            let mut corners = vertices.clone();
            if area < 0.0 {
                corners.reverse();
            }
            corners
        }
        Shape::Rectangle {
            center,
            half_extents,
            angle,
        } => rectangle(*center, *half_extents, *angle),
    }
}

/// Returns the corners of a rectangle (m).
pub fn rectangle(center: [f64; 2], half_extents: [f64; 2], angle: f64) -> Vec<[f64; 2]> {
    let (sin, cos) = math::sincos(angle);
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(sx, sy)| {
            let (x, y) = (sx * half_extents[0], sy * half_extents[1]);
            [center[0] + cos * x - sin * y, center[1] + sin * x + cos * y]
        })
        .to_vec()
}

fn corner_count(shape: &Shape) -> usize {
    match shape {
        Shape::Polygon { vertices } => vertices.len(),
        _ => 4,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn covered(rectangles: &[[[f64; 2]; 2]], x: f64, y: f64) -> usize {
        rectangles
            .iter()
            .filter(|[min, max]| x > min[0] && x < max[0] && y > min[1] && y < max[1])
            .count()
    }

    proptest! {
        #[test]
        fn rectangles_cover_every_occupied_cell_once_and_no_free_one(
            width in 1_usize..12,
            bits in prop::collection::vec(any::<bool>(), 1..120),
        ) {
            let height = bits.len().div_ceil(width);
            let mut occupied = bits;
            occupied.resize(width * height, false);
            let cells = Cells { origin: [-1.0, 2.0], side: 0.5, width, occupied };
            let rectangles = cells.rectangles();
            for (i, &cell) in cells.occupied.iter().enumerate() {
                let x = -1.0 + 0.5 * ((i % width) as f64 + 0.5);
                let y = 2.0 + 0.5 * ((i / width) as f64 + 0.5);
                prop_assert_eq!(covered(&rectangles, x, y), usize::from(cell));
            }
        }
    }

    #[test]
    fn a_block_is_one_rectangle() {
        let mut occupied = vec![false; 25];
        for i in [6, 7, 8, 11, 12, 13] {
            occupied[i] = true;
        }
        let cells = Cells {
            origin: [0.0; 2],
            side: 1.0,
            width: 5,
            occupied,
        };
        assert_eq!(cells.rectangles(), [[[1.0, 1.0], [4.0, 3.0]]]);
    }

    #[test]
    fn a_complex_grid_is_drawn_coarser() {
        let width = 400;
        let occupied = (0..width * width)
            .map(|i| (i / width + i % width) % 2 == 0)
            .collect();
        let cells = Cells {
            origin: [0.0; 2],
            side: 0.1,
            width,
            occupied,
        };
        let rectangles = cells.rectangles();
        assert!(rectangles.len() <= MAX_RECTANGLES);
        assert_eq!(covered(&rectangles, 20.02, 20.02), 1);
    }

    #[test]
    fn all_polygons_have_the_same_orientation() {
        let one_way = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let vertices = one_way.iter().rev().copied().collect();
        let other_way = corners(&Shape::Polygon { vertices });
        assert_eq!(other_way, one_way);
        assert_eq!(
            corners(&Shape::Polygon {
                vertices: one_way.clone()
            }),
            one_way
        );
    }

    #[test]
    fn an_inconsistent_map_message_is_ignored() {
        let header = MapHeader {
            resolution: 0.1,
            width: 3,
            height: 2,
            ..MapHeader::default()
        };
        let mut static_scene = StaticScene::default();
        static_scene.use_cells(&header, &[MapCell::default(); 5]);
        static_scene.use_cells(
            &MapHeader {
                resolution: f64::NAN,
                ..header
            },
            &[MapCell::default(); 6],
        );
        assert_eq!(static_scene, StaticScene::default());
        static_scene.use_cells(&header, &[MapCell::default(); 6]);
        assert!(
            (static_scene.max[0] - 0.3).abs() < 1e-12 && (static_scene.max[1] - 0.2).abs() < 1e-12
        );
    }
}
