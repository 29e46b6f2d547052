//! Connected places of a map for a robot.

use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::Point2;

use crate::grid::{Grid, GridFrame};
use crate::region::Region;

/// Maximum number of sets of passages that a map keeps: robots have few sizes.
const MAX_PASSAGE_SETS: usize = 8;

/// Cells that a disc may pass, and their connections across sides (not across corners).
///
/// ```
/// use geometry::map::{ObstacleSpec, VectorMap, WorldMap};
/// use geometry::region::Region;
/// use geometry::shape::Shape;
/// use nalgebra::Point2;
///
/// // A wall with a gap of 1 m at its upper end.
/// let mut room = VectorMap::empty([0.0, 0.0], [4.0, 4.0], 0.1);
/// room.obstacles.push(ObstacleSpec {
///     name: String::new(),
///     shape: Shape::Rectangle { center: [2.0, 1.5], half_extents: [0.1, 1.5], angle: 0.0 },
/// });
/// let map = WorldMap::from_vectors(&room)?;
/// let (start, goal) = (Point2::new(1.0, 1.0), Region::Circle { center: [3.0, 1.0], radius: 0.2 });
/// assert!(map.shapes().passages(0.3).reach([start]).meets(&goal));
/// assert!(!map.shapes().passages(0.6).reach([start]).meets(&goal));
/// # Ok::<(), geometry::map::VectorMapError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Passages {
    frame: GridFrame,
    /// Per cell, the number of its room, from 1; 0 for a closed cell.
    rooms: Vec<u32>,
}

impl Passages {
    /// The cells whose clearance (m) is above 0 and at least `needed` (m).
    pub fn new(clearance: &Grid<f32>, needed: f64) -> Self {
        let frame = clearance.frame;
        let is_open = |cell: usize| {
            let clearance = clearance.cells.get(cell);
            clearance.is_some_and(|&c| c > 0.0 && f64::from(c) >= needed)
        };
        let mut rooms = vec![0; frame.len()];
        let mut next = Vec::new();
        let mut room = 0;
        for first in 0..frame.len() {
            if rooms[first] != 0 || !is_open(first) {
                continue;
            }
            room += 1;
            rooms[first] = room;
            next.push(first);
            while let Some(cell) = next.pop() {
                for beside in sides(&frame, cell).into_iter().flatten() {
                    if rooms[beside] == 0 && is_open(beside) {
                        rooms[beside] = room;
                        next.push(beside);
                    }
                }
            }
        }
        Self { frame, rooms }
    }

    /// The cells that a robot reaches from these positions (m). The cell of a position is open whatever its
    /// clearance; a position outside the map leads nowhere.
    pub fn reach(&self, starts: impl IntoIterator<Item = Point2<f64>>) -> Reach<'_> {
        let mut reach = Reach {
            passages: self,
            starts: Vec::new(),
            rooms: Vec::new(),
        };
        let cells = starts.into_iter().filter_map(|p| self.frame.index_at(p));
        for cell in cells {
            reach.starts.push(cell);
            let around = sides(&self.frame, cell).into_iter().flatten();
            let rooms = around.chain([cell]).filter_map(|c| self.rooms.get(c));
            reach.rooms.extend(rooms.filter(|&&room| room != 0));
        }
        reach.rooms.sort_unstable();
        reach.rooms.dedup();
        reach
    }
}

/// The cells next to a cell.
fn sides(frame: &GridFrame, cell: usize) -> [Option<usize>; 4] {
    let (col, row) = (cell % frame.width, cell / frame.width);
    [
        (col > 0).then(|| cell - 1),
        (row > 0).then(|| cell - frame.width),
        (col + 1 < frame.width).then(|| cell + 1),
        (row + 1 < frame.height).then(|| cell + frame.width),
    ]
}

/// Cells that a robot reaches from its start.
#[derive(Debug, Clone)]
pub struct Reach<'a> {
    passages: &'a Passages,
    starts: Vec<usize>,
    /// In ascending order.
    rooms: Vec<u32>,
}

impl Reach<'_> {
    /// Returns `true` if the robot reaches a cell, given by its storage index.
    pub fn includes(&self, cell: usize) -> bool {
        let room = self.passages.rooms.get(cell);
        room.is_some_and(|room| self.rooms.binary_search(room).is_ok())
            || self.starts.contains(&cell)
    }

    /// Returns `true` if the robot reaches a cell whose centre lies in the region, or the cell that contains
    /// the region's centre (a region may be smaller than a cell).
    pub fn meets(&self, region: &Region) -> bool {
        let frame = &self.passages.frame;
        let center = region.center();
        if frame
            .index_at(center)
            .is_some_and(|cell| self.includes(cell))
        {
            return true;
        }
        let far = region.bounding_radius();
        // One more cell on each side: rounding must not miss one.
        let cells = |from: f64, to: f64, origin: f64, count: usize| {
            let cell = |at: f64| (at - origin) / frame.resolution;
            let first = (cell(from) - 1.0).max(0.0) as usize;
            let end = ((cell(to) + 2.0).max(0.0) as usize).min(count);
            first..end
        };
        let columns = cells(center.x - far, center.x + far, frame.origin.x, frame.width);
        let rows = cells(center.y - far, center.y + far, frame.origin.y, frame.height);
        rows.flat_map(|row| columns.clone().map(move |col| (col, row)))
            .any(|(col, row)| {
                self.includes(frame.index(col, row)) && region.contains(frame.center(col, row))
            })
    }
}

/// The requested passages of one map; clones share them.
#[derive(Debug, Clone, Default)]
pub struct KnownPassages(Arc<Mutex<Vec<PassageEntry>>>);

/// The bits of a needed clearance, and the passages for it.
type PassageEntry = (u64, Arc<Passages>);

impl KnownPassages {
    /// As [`Passages::new`], once per `needed`.
    pub(super) fn get(&self, clearance: &Grid<f32>, needed: f64) -> Arc<Passages> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let key = needed.to_bits();
        if let Some((_, passages)) = known.iter().find(|(bits, _)| *bits == key) {
            return Arc::clone(passages);
        }
        let passages = Arc::new(Passages::new(clearance, needed));
        if known.len() >= MAX_PASSAGE_SETS {
            known.remove(0);
        }
        known.push((key, Arc::clone(&passages)));
        passages
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn grid(width: usize, cells: &[f32]) -> Grid<f32> {
        let frame = GridFrame {
            width,
            height: cells.len() / width,
            resolution: 0.5,
            origin: Point2::new(-1.0, 2.0),
        };
        let cells = cells[..frame.len()].to_vec();
        Grid { frame, cells }
    }

    /// Fills the grid cell by cell from the starts.
    fn flood(grid: &Grid<f32>, needed: f64, starts: &[Point2<f64>]) -> Vec<bool> {
        let mut reached = vec![false; grid.frame.len()];
        let mut next: Vec<usize> = starts
            .iter()
            .filter_map(|&p| grid.frame.index_at(p))
            .collect();
        for &cell in &next {
            reached[cell] = true;
        }
        while let Some(cell) = next.pop() {
            for beside in sides(&grid.frame, cell).into_iter().flatten() {
                let clearance = grid.cells[beside];
                let open = clearance > 0.0 && f64::from(clearance) >= needed;
                if open && !reached[beside] {
                    reached[beside] = true;
                    next.push(beside);
                }
            }
        }
        reached
    }

    #[test]
    fn rooms_are_joined_from_side_to_side_only() {
        let map = grid(3, &[1.0, 0.1, 1.0, 0.1, 1.0, 0.1, 1.0, 1.0, 0.1]);
        let passages = Passages::new(&map, 0.5);
        let reach = passages.reach([map.frame.center(1, 1)]);
        let reached: Vec<bool> = (0..9).map(|cell| reach.includes(cell)).collect();
        let expected = [0, 0, 0, 0, 1, 0, 1, 1, 0].map(|n| n == 1);
        assert_eq!(reached, expected);
        assert_eq!(passages.reach([Point2::new(99.0, 0.0)]).rooms, [0_u32; 0]);
    }

    #[test]
    fn a_region_smaller_than_a_cell_is_met_by_its_centre() {
        let map = grid(2, &[1.0, 1.0]);
        let passages = Passages::new(&map, 0.5);
        let reach = passages.reach([map.frame.center(0, 0)]);
        let tiny = |x: f64| Region::Circle {
            center: [x, 2.01],
            radius: 1e-3,
        };
        assert!(reach.meets(&tiny(-0.01)));
        assert!(!reach.meets(&tiny(0.01)), "outside the map");
    }

    #[test]
    fn a_map_keeps_the_requested_passages() {
        let map = grid(2, &[1.0, 1.0]);
        let known = KnownPassages::default();
        let first = known.get(&map, 0.5);
        assert!(Arc::ptr_eq(&first, &known.clone().get(&map, 0.5)));
        for size in 0..2 * MAX_PASSAGE_SETS {
            known.get(&map, size as f64);
        }
        assert_eq!(known.0.lock().unwrap().len(), MAX_PASSAGE_SETS);
    }

    proptest! {
        #[test]
        fn what_is_reached_is_what_a_flood_reaches(
            cells in prop::collection::vec(prop_oneof![Just(0.0_f32), 0.0..1.0_f32], 6..80),
            width in 1_usize..6,
            needed in -0.2..0.8_f64,
            starts in prop::collection::vec((-1.5..2.5_f64, 1.5..9.0_f64), 0..4),
            region in (-1.5..2.5_f64, 1.5..9.0_f64, 0.01..2.0_f64, 0.01..2.0_f64, -3.0..3.0_f64),
        ) {
            let map = grid(width, &cells);
            let starts: Vec<_> = starts.into_iter().map(|(x, y)| Point2::new(x, y)).collect();
            let flooded = flood(&map, needed, &starts);
            let passages = Passages::new(&map, needed);
            let reach = passages.reach(starts);
            for (cell, &reached) in flooded.iter().enumerate() {
                prop_assert_eq!(reach.includes(cell), reached, "cell {}", cell);
            }
            let region = Region::Rectangle {
                center: [region.0, region.1],
                half_extents: [region.2, region.3],
                angle: region.4,
            };
            let met = (0..flooded.len()).any(|cell| {
                let (col, row) = (cell % width, cell / width);
                let inside = region.contains(map.frame.center(col, row))
                    || map.frame.index_at(region.center()) == Some(cell);
                flooded[cell] && inside
            });
            prop_assert_eq!(reach.meets(&region), met);
        }
    }
}
