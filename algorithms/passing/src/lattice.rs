//! Lattice of points where one robot alone can be.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use geometry::grid::GridFrame;
use nalgebra::{Point2, Vector2};
use planner_view::free_space::FreeSpace;

use super::spacing::Spacing;

/// Number of cells per distance of two places.
const CELLS: f64 = 10.0;
/// Range around the robots within which they make room (m).
const RANGE: f64 = 8.0;
/// Maximum number of cells.
const MAX_CELLS: usize = 1 << 20;
/// Maximum number of points, the nearest ones to the robots.
const MAX_POINTS: usize = 40_000;
/// Index of a cell without a point.
const NONE: usize = usize::MAX;

/// Points at most one to a cell, and the straight ways between neighbours.
#[derive(Debug, Clone)]
pub struct Lattice {
    frame: GridFrame,
    /// Index of each cell's point.
    index: Vec<usize>,
    /// The points (m).
    pub points: Vec<Point2<f64>>,
    /// Neighbours of each point.
    pub next: Vec<Vec<usize>>,
    clearance: f64,
}

/// Shortest ways from one place.
pub struct ShortestPaths {
    /// Length to each point (m).
    pub lengths: Vec<f64>,
    before: Vec<usize>,
}

impl ShortestPaths {
    /// Returns the way to a point, without its start.
    pub(super) fn to(&self, lattice: &Lattice, mut point: usize) -> Vec<Point2<f64>> {
        let mut way = Vec::new();
        while point != NONE {
            way.push(lattice.points[point]);
            point = self.before[point];
        }
        way.reverse();
        way
    }
}

impl Lattice {
    /// Returns the points that robots at `starts` (m) can reach past the bodies that stay at `blocked` (m). The goals (m) and starts are
    /// points if they are free. `None` if the robots are too far apart for one lattice.
    pub(super) fn new(
        space: &FreeSpace,
        spacing: &Spacing,
        starts: &[Point2<f64>],
        goals: &[Point2<f64>],
        blocked: &[Point2<f64>],
    ) -> Option<Self> {
        let frame = frame(space, spacing, starts)?;
        let mut lattice = Self {
            index: vec![NONE; frame.len()],
            frame,
            points: Vec::new(),
            next: Vec::new(),
            clearance: spacing.clearance,
        };
        let resolution = lattice.frame.resolution;
        let free = |cell: usize| {
            let center = lattice.frame.center(cell % frame.width, cell / frame.width);
            let mut known = goals.iter().chain(starts).copied();
            let known = known
                .find(|&p| frame.index_at(p) == Some(cell) && space.is_free(p, spacing.clearance));
            // Its middle may be too near to a wall although a narrow passage leads through the cell.
            let at =
                known.or_else(|| space.free_place(center, spacing.clearance, 0.5 * resolution))?;
            let is_clear = |body: &Point2<f64>| (body - at).norm() >= spacing.apart;
            blocked.iter().all(is_clear).then_some(at)
        };
        let mut seen = vec![false; frame.len()];
        let mut queue: VecDeque<usize> = starts
            .iter()
            .filter_map(|&p| frame.index_at(p))
            .flat_map(|cell| around(&frame, cell, 2))
            .collect();
        let mut cells = Vec::new();
        let mut index = core::mem::take(&mut lattice.index);
        let mut points = Vec::new();
        while let Some(cell) = queue.pop_front().filter(|_| points.len() < MAX_POINTS) {
            if core::mem::replace(&mut seen[cell], true) {
                continue;
            }
            let Some(at) = free(cell) else { continue };
            index[cell] = points.len();
            points.push(at);
            cells.push(cell);
            queue.extend(around(&frame, cell, 1));
        }
        let neighbours = |(i, &cell): (usize, &usize)| {
            around(&frame, cell, 1)
                .map(|near| index[near])
                .filter(|&near| near != NONE && near != i)
                .filter(|&near| space.segment_is_free(points[i], points[near], spacing.clearance))
                .collect()
        };
        lattice.next = cells.iter().enumerate().map(neighbours).collect();
        (lattice.index, lattice.points) = (index, points);
        Some(lattice)
    }

    /// Returns the points within a distance (m) of a place, in the order of their cells.
    pub(super) fn near(&self, at: Point2<f64>, distance: f64) -> impl Iterator<Item = usize> {
        let by = (distance / self.frame.resolution).ceil() as usize + 1;
        self.frame
            .index_at(at)
            .into_iter()
            .flat_map(move |cell| around(&self.frame, cell, by))
            .map(|cell| self.index[cell])
            .filter(move |&i| i != NONE && (self.points[i] - at).norm() < distance)
    }

    /// Returns the shortest ways from a place of a robot (m).
    pub(super) fn ways(&self, space: &FreeSpace, from: Point2<f64>) -> ShortestPaths {
        let mut ways = ShortestPaths {
            lengths: vec![f64::INFINITY; self.points.len()],
            before: vec![NONE; self.points.len()],
        };
        let mut queue = BinaryHeap::new();
        let clearance = self.clearance.min(space.distance(from) - 1e-6);
        for i in self.near(from, 2.0 * self.frame.resolution) {
            if space.segment_is_free(from, self.points[i], clearance) {
                ways.lengths[i] = (self.points[i] - from).norm();
                queue.push(Reverse((ways.lengths[i].to_bits(), i)));
            }
        }
        while let Some(Reverse((bits, i))) = queue.pop() {
            if bits != ways.lengths[i].to_bits() {
                continue;
            }
            for &next in &self.next[i] {
                let length = ways.lengths[i] + (self.points[next] - self.points[i]).norm();
                if length < ways.lengths[next] {
                    (ways.lengths[next], ways.before[next]) = (length, i);
                    queue.push(Reverse((length.to_bits(), next)));
                }
            }
        }
        ways
    }
}

/// Returns the cells about the robots; `None` if there are too many.
fn frame(space: &FreeSpace, spacing: &Spacing, starts: &[Point2<f64>]) -> Option<GridFrame> {
    let range = Vector2::repeat(RANGE);
    let first = *starts.first()?;
    let min = starts.iter().fold(first, |min, p| min.inf(p)) - range;
    let max = starts.iter().fold(first, |max, p| max.sup(p)) + range;
    let inset = Vector2::repeat(spacing.clearance);
    let (min, max) = (
        min.sup(&(space.bounds().min + inset)),
        max.inf(&(space.bounds().max - inset)),
    );
    let resolution = spacing.places / CELLS;
    let cells = (max - min).map(|side| (side / resolution).max(0.0).ceil() + 1.0);
    (cells.x * cells.y <= MAX_CELLS as f64).then(|| GridFrame {
        width: cells.x as usize,
        height: cells.y as usize,
        resolution,
        origin: min - Vector2::repeat(0.5 * resolution),
    })
}

/// Returns the cells at most `by` columns and rows away.
fn around(frame: &GridFrame, i: usize, by: usize) -> impl Iterator<Item = usize> + use<> {
    let (col, row, width) = (i % frame.width, i / frame.width, frame.width);
    let cols = col.saturating_sub(by)..(col + by + 1).min(width);
    let rows = row.saturating_sub(by)..(row + by + 1).min(frame.height);
    rows.flat_map(move |row| cols.clone().map(move |col| row * width + col))
}
