//! The last resort: a shortest path among the remembered echoes.
//!
//! Space without an echo counts as free, so a path may lead through space that the robot has not seen. A
//! robot that plans again at each obstacle found there reaches every reachable point, or finds that the
//! echoes enclose it.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use nalgebra::{Point2, Vector2};

use super::remembered::EchoMemory;
use super::surroundings::Surroundings;
use super::{Advice, MARGIN, Sight};

/// Maximum number of plans: bounds the drive where obstacles move.
const MAX_PLANS: u32 = 500;
/// Side of a cell, in grown radii.
const CELL: f64 = 0.25;
/// Maximum number of cells; a larger area gets larger cells.
const MAX_CELLS: f64 = 1e6;
/// Steps to the neighbours of a cell, and their lengths (the ratio 7 : 5 is about √2).
const STEPS: [(i64, i64, u32); 8] = [
    (1, 0, 5),
    (0, 1, 5),
    (-1, 0, 5),
    (0, -1, 5),
    (1, 1, 7),
    (-1, 1, 7),
    (-1, -1, 7),
    (1, -1, 7),
];

/// A drive along planned paths.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Detour {
    /// The rest of the path (m), its end first.
    path: Vec<Point2<f64>>,
    plans: u32,
}

impl Detour {
    /// The point to drive to (m). `grown` is the distance that the path keeps from echoes (m); the view grows
    /// them less, so that they do not hide the path. Without such a path it tries ones with less clearance:
    /// the robot may have squeezed in where it is.
    ///
    /// # Errors
    /// [`Advice::Unreachable`] if the echoes enclose the robot or the goal, even for a disc so small that every
    /// passage for the robot shows in the cells; [`Advice::Stuck`] if that is not certain: after [`MAX_PLANS`]
    /// paths, or if the cells are too coarse.
    pub(super) fn step(
        &mut self,
        view: &Surroundings,
        sight: &Sight,
        remembered: &EchoMemory,
        grown: f64,
    ) -> Result<Point2<f64>, Advice> {
        if let Some(point) = self.visible(view) {
            return Ok(point);
        }
        if self.plans >= MAX_PLANS {
            return Err(Advice::Stuck);
        }
        self.plans += 1;
        let radius = grown - MARGIN;
        // The farthest that a point is from the centre of its cell.
        let off = CELL * grown * core::f64::consts::FRAC_1_SQRT_2;
        let mut none = Advice::Unreachable;
        for clearance in [grown, radius + 0.5 * MARGIN, radius - off] {
            let mut cells = Cells::new(view.here, sight.goal, remembered, grown);
            cells.block(remembered, clearance);
            if let Some(path) = cells.path(view.here, sight.goal, sight.tolerance) {
                self.path = path;
                // A robot inside a grown obstacle leaves it first.
                let point = self.visible(view).or_else(|| self.path.last().copied());
                return point.ok_or(Advice::Stuck);
            }
            if cells.pitch > CELL * grown {
                none = Advice::Stuck;
            }
        }
        Err(none)
    }

    /// The farthest visible point of the path (m) beyond the nearest one.
    fn visible(&mut self, view: &Surroundings) -> Option<Point2<f64>> {
        let off = |point: &Point2<f64>| (point - view.here).norm();
        let nearest = (0..self.path.len()).min_by(|&a, &b| {
            let off_of = |k: usize| self.path.get(k).map_or(f64::INFINITY, off);
            off_of(a).total_cmp(&off_of(b))
        })?;
        self.path.truncate(nearest + 1);
        let is_visible = |point: &&Point2<f64>| {
            let distance = off(point);
            let unit = (*point - view.here) / distance;
            distance <= view.reach && view.free_towards(unit) >= distance
        };
        let ahead = self.path.get(..nearest.max(1))?;
        ahead.iter().find(is_visible).copied()
    }
}

/// The free cells around the remembered echoes.
struct Cells {
    origin: Point2<f64>,
    pitch: f64,
    width: i64,
    height: i64,
    blocked: Vec<bool>,
}

impl Cells {
    /// All cells are free; a border of cells surrounds all echoes.
    fn new(here: Point2<f64>, goal: Point2<f64>, remembered: &EchoMemory, grown: f64) -> Self {
        let (mut low, mut high) = (here.inf(&goal), here.sup(&goal));
        for echo in remembered.echoes() {
            (low, high) = (low.inf(&echo), high.sup(&echo));
        }
        let mut pitch = CELL * grown;
        let mut border = Vector2::repeat(grown + 2.0 * pitch);
        let mut size = (high - low + 2.0 * border) / pitch;
        if size.x * size.y > MAX_CELLS {
            pitch *= (size.x * size.y / MAX_CELLS).sqrt();
            border = Vector2::repeat(grown + 2.0 * pitch);
            size = (high - low + 2.0 * border) / pitch;
        }
        let (width, height) = (size.x.ceil() as i64, size.y.ceil() as i64);
        Self {
            origin: low - border,
            pitch,
            width,
            height,
            blocked: vec![false; (width * height) as usize],
        }
    }

    /// Blocks the cells with an echo nearer than this (m).
    fn block(&mut self, remembered: &EchoMemory, clearance: f64) {
        for echo in remembered.echoes() {
            for cell in self.within(echo, clearance) {
                if let Some(blocked) = self.blocked.get_mut(cell) {
                    *blocked = true;
                }
            }
        }
    }

    fn index(&self, col: i64, row: i64) -> Option<usize> {
        let inside = (0..self.width).contains(&col) && (0..self.height).contains(&row);
        inside.then(|| (row * self.width + col) as usize)
    }

    fn place(&self, cell: usize) -> (i64, i64) {
        (cell as i64 % self.width, cell as i64 / self.width)
    }

    fn center(&self, cell: usize) -> Point2<f64> {
        let (col, row) = self.place(cell);
        self.origin + Vector2::new(col as f64 + 0.5, row as f64 + 0.5) * self.pitch
    }

    /// The cells whose centres are nearer to a point than `reach` (m).
    fn within(&self, at: Point2<f64>, reach: f64) -> Vec<usize> {
        let from = (at - self.origin).map(|value| ((value - reach) / self.pitch).floor() as i64);
        let to = (at - self.origin).map(|value| ((value + reach) / self.pitch).floor() as i64);
        let square = (from.y..=to.y).flat_map(|row| (from.x..=to.x).map(move |col| (col, row)));
        square
            .filter_map(|(col, row)| self.index(col, row))
            .filter(|&cell| (self.center(cell) - at).norm() < reach)
            .collect()
    }

    /// The free cell nearest to a point within a reach (m).
    fn nearest(&self, at: Point2<f64>, reach: f64) -> Option<usize> {
        let off = |cell: &usize| (self.center(*cell) - at).norm();
        self.within(at, reach)
            .into_iter()
            .filter(|&cell| self.blocked.get(cell) == Some(&false))
            .min_by(|a, b| off(a).total_cmp(&off(b)))
    }

    /// The shortest path (m) to within `tolerance` (m) of the goal, its end first; `None` if there is none
    /// (A\*, Hart, Nilsson and Raphael 1968).
    fn path(
        &self,
        here: Point2<f64>,
        goal: Point2<f64>,
        tolerance: f64,
    ) -> Option<Vec<Point2<f64>>> {
        let start = self.nearest(here, 5.0 * self.pitch)?;
        let end = self.nearest(goal, tolerance.max(self.pitch))?;
        let to = self.place(end);
        let left = |(col, row): (i64, i64)| {
            let (x, y) = (col.abs_diff(to.0), row.abs_diff(to.1));
            (5 * x.max(y) + 2 * x.min(y)) as u32
        };
        let mut lengths = vec![u32::MAX; self.blocked.len()];
        let mut before = vec![usize::MAX; self.blocked.len()];
        let mut queue = BinaryHeap::new();
        *lengths.get_mut(start)? = 0;
        queue.push(Reverse((left(self.place(start)), start)));
        while let Some(Reverse((bound, cell))) = queue.pop() {
            let (col, row) = self.place(cell);
            let length = *lengths.get(cell)?;
            if cell == end {
                break;
            }
            if bound > length + left((col, row)) {
                continue;
            }
            for (x, y, step) in STEPS {
                let Some(next) = self.index(col + x, row + y) else {
                    continue;
                };
                let length = length + step;
                if self.blocked.get(next) == Some(&false) && length < *lengths.get(next)? {
                    *lengths.get_mut(next)? = length;
                    *before.get_mut(next)? = cell;
                    queue.push(Reverse((length + left((col + x, row + y)), next)));
                }
            }
        }
        if *lengths.get(end)? == u32::MAX {
            return None;
        }
        let cells = core::iter::successors(Some(end), |&cell| {
            before.get(cell).copied().filter(|&cell| cell != usize::MAX)
        });
        Some(cells.map(|cell| self.center(cell)).collect())
    }
}
