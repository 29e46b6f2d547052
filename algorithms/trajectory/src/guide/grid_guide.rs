//! The paper's initial path: a wavefront on a grid, pulled taut.
//!
//! From the goal a wave spreads over the free cells of a grid (Batavia and Nourbakhsh, *Path Planning
//! for the Cye Personal Robot*, IROS 2000); descent of its times gives an obstacle-free corridor.
//! Corners of the corridor are then skipped wherever the straight line is free, so that the
//! optimisation (in the paper, of a B-spline in the corridor) begins with fewer detours.

use nalgebra::{Point2, Vector2};
use pathfinding::directed::astar::astar;

use crate::guide::Guide;
use crate::obstacle_field::ExactObstacleField;

/// Cells along the longer side of the bounds.
const CELLS: f64 = 96.0;
/// Costs of a step along the axes and of a diagonal step, in the ratio 1 : √2.
const STEPS: [u32; 2] = [70, 99];
/// Maximum distance from start or goal to the next free cell (cells).
const ENTRY: i32 = 3;

type Cell = (i32, i32);

/// The grid of cells, represented by their centres.
struct Grid<'a> {
    obstacle_field: &'a ExactObstacleField,
    origin: Point2<f64>,
    side: f64,
    width: i32,
    height: i32,
}

impl Grid<'_> {
    fn center(&self, (col, row): Cell) -> Point2<f64> {
        let offset = Vector2::new(f64::from(col) + 0.5, f64::from(row) + 0.5);
        self.origin + offset * self.side
    }

    fn cell(&self, p: Point2<f64>) -> Cell {
        let at = (p - self.origin) / self.side;
        let index = |at: f64, count: i32| (at.floor() as i32).clamp(0, count - 1);
        (index(at.x, self.width), index(at.y, self.height))
    }

    fn is_inside(&self, (col, row): Cell) -> bool {
        (0..self.width).contains(&col) && (0..self.height).contains(&row)
    }

    /// The nearest cell that a straight line from a point reaches.
    fn entry(&self, p: Point2<f64>) -> Option<Cell> {
        let (col, row) = self.cell(p);
        let near = |a: &Cell, b: &Cell| {
            let [a, b] = [a, b].map(|cell| (self.center(*cell) - p).norm());
            a.total_cmp(&b)
        };
        (-ENTRY..=ENTRY)
            .flat_map(|dy| (-ENTRY..=ENTRY).map(move |dx| (col + dx, row + dy)))
            .filter(|&cell| self.is_inside(cell) && self.is_free(p, self.center(cell)))
            .min_by(near)
    }

    fn is_free(&self, a: Point2<f64>, b: Point2<f64>) -> bool {
        self.obstacle_field
            .space
            .segment_is_free(a, b, self.obstacle_field.clearance)
    }
}

/// The path of a wavefront; `None` if the grid is too coarse for any.
pub fn guide(
    obstacle_field: &ExactObstacleField,
    start: Point2<f64>,
    goal: Point2<f64>,
) -> Option<Guide> {
    let bounds = obstacle_field.space.bounds();
    let size = bounds.max - bounds.min;
    let side = size.x.max(size.y) / CELLS;
    let grid = Grid {
        obstacle_field,
        origin: bounds.min,
        side,
        width: (size.x / side).ceil() as i32,
        height: (size.y / side).ceil() as i32,
    };
    let (first, last) = (grid.entry(start)?, grid.entry(goal)?);
    let steps = |&(col, row): &Cell| {
        let from = grid.center((col, row));
        let around = (-1..=1).flat_map(move |dy| (-1..=1).map(move |dx| (dx, dy)));
        let free = around
            .filter(|&step| step != (0, 0))
            .map(|(dx, dy)| ((col + dx, row + dy), STEPS[usize::from(dx != 0 && dy != 0)]))
            .filter(|&(cell, _)| grid.is_inside(cell) && grid.is_free(from, grid.center(cell)));
        free.collect::<Vec<_>>()
    };
    // The wave's time, a lower bound on the time of a straight path.
    let ahead = |&(col, row): &Cell| {
        let (dx, dy) = (col.abs_diff(last.0), row.abs_diff(last.1));
        dx.min(dy) * STEPS[1] + (dx.max(dy) - dx.min(dy)) * STEPS[0]
    };
    let (cells, _) = astar(&first, steps, ahead, |&cell| cell == last)?;
    let corners = cells.into_iter().map(|cell| grid.center(cell));
    let all: Vec<Point2<f64>> = core::iter::once(start)
        .chain(corners)
        .chain([goal])
        .collect();
    Guide::through(&taut(&grid, &all))
}

/// The corners that remain when all unnecessary ones are skipped.
fn taut(grid: &Grid<'_>, all: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let mut kept = vec![all[0]];
    let mut at = 0;
    while at + 1 < all.len() {
        let next = (at + 2..all.len())
            .rev()
            .find(|&next| grid.is_free(all[at], all[next]))
            .unwrap_or(at + 1);
        kept.push(all[next]);
        at = next;
    }
    kept
}
