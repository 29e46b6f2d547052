//! One goal for many starts.

use std::sync::Arc as Shared;
use std::sync::atomic::{AtomicU32, Ordering};

use nalgebra::Point2;

use super::backwards::backwards;
use super::graph::NONE;
use super::heap::Heap;
use super::near::Join;
use super::{Inner, PathLeg, ShortestPath, search};

/// Not computed yet.
const UNKNOWN: u32 = u32::MAX;
/// The cell contains points that are not free: only the straight line is a bound.
const MIXED: f32 = -1.0;

/// The shortest paths to one goal, made by [`TangentGraph::towards`](super::TangentGraph::towards).
///
/// It holds the exact continuation from every departure of the graph. A query ends at the first
/// free tangent in the order of total length.
#[derive(Debug)]
pub struct Towards {
    inner: Shared<Inner>,
    goal: Point2<f64>,
    /// End of the paths, if the goal is reachable, and its distance (m) from the goal.
    settled: Option<(Point2<f64>, f64)>,
    /// Cost (m) from every vertex to the settled goal.
    costs: Vec<f64>,
    /// Tangents to the goal, by their track: position of departure, and length (m).
    last: Vec<Option<(f64, f64)>>,
    /// Bits of lower bounds (m) for the cells of the clearance field, computed on first use.
    cells: Vec<AtomicU32>,
}

impl Towards {
    pub(super) fn new(inner: Shared<Inner>, goal: Point2<f64>) -> Self {
        let settled = inner.settle(goal).map(|q| (q, (q - goal).norm()));
        let mut last = vec![None; inner.graph.tracks()];
        let mut costs = Vec::new();
        if let Some((q, _)) = settled {
            let mut joins = Vec::new();
            inner.near.joins(&inner.space, &inner.graph, q, &mut joins);
            joins.retain(|join| inner.space.segment_is_free(join.touch, q, inner.radius));
            for join in &joins {
                let at = inner.graph.opposite(join.track, join.at);
                last[join.track as usize ^ 1] = Some((at, join.length));
            }
            let seeds = inner
                .graph
                .vertices
                .iter()
                .enumerate()
                .filter_map(|(i, v)| {
                    let rest = arrival(&inner, &last, v.to_track, v.to_at)?;
                    Some((i as u32, v.length + rest))
                });
            backwards(&inner.graph, seeds, &mut costs, &mut Heap::default());
        }
        let cells = inner.space.shapes().frame().len();
        Self {
            inner,
            goal,
            settled,
            costs,
            last,
            cells: core::iter::repeat_with(|| AtomicU32::new(UNKNOWN))
                .take(cells)
                .collect(),
        }
    }

    /// The goal (m).
    pub fn goal(&self) -> Point2<f64> {
        self.goal
    }

    /// Length (m) of the shortest path from a point; `None` if there is none.
    ///
    /// The same as [`TangentGraph::distance`](super::TangentGraph::distance), faster.
    pub fn distance(&self, from: Point2<f64>) -> Option<f64> {
        let (goal, aside) = self.settled?;
        let p = self.inner.settle(from)?;
        let aside = aside + (p - from).norm();
        if self.inner.space.segment_is_free(p, goal, self.inner.radius) {
            return Some(aside + (goal - p).norm());
        }
        search::with_joins(|joins| self.along_tangents(p, joins)).map(|length| aside + length)
    }

    /// The shortest path from a point; `None` if there is none.
    pub fn path(&self, from: Point2<f64>) -> Option<ShortestPath> {
        let mut legs: Vec<PathLeg> = Vec::new();
        let length = search::with_scratch(|scratch| {
            self.inner.search(from, self.goal, Some(&mut legs), scratch)
        })?;
        Some(ShortestPath { length, legs })
    }

    fn along_tangents(&self, p: Point2<f64>, joins: &mut Vec<Join>) -> Option<f64> {
        let Inner {
            space,
            graph,
            near,
            radius,
            ..
        } = &*self.inner;
        near.joins(space, graph, p, joins);
        // From here on a tangent's length stands for the length of the whole path over it.
        for join in joins.iter_mut() {
            let (next, arc) = graph.departure(join.track, join.at);
            let onward = match self.costs.get(next as usize) {
                Some(cost) if next != NONE => arc + cost,
                _ => f64::INFINITY,
            };
            let straight = arrival(&self.inner, &self.last, join.track, join.at);
            join.length += straight.map_or(onward, |straight| straight.min(onward));
        }
        joins.retain(|join| join.length.is_finite());
        while !joins.is_empty() {
            let by_length = |a: &usize, b: &usize| joins[*a].length.total_cmp(&joins[*b].length);
            let best = (0..joins.len()).min_by(by_length)?;
            let best = joins.swap_remove(best);
            if space.segment_is_free(p, best.touch, *radius) {
                return Some(best.length);
            }
        }
        None
    }

    /// A lower bound (m) on [`Self::distance`] by one look-up; infinite where there is no path, 0
    /// for points that are not finite. Made for heuristics and pruning; the first
    /// question of a cell takes as long as a [`Self::distance`].
    ///
    /// The bound is admissible: in a cell whose points are all free, the straight line between any
    /// two points is a path. So their distances to the goal differ by at most its length: `d(p) ≥
    /// d(c) − |p − c|` with the exact distance of the centre `c`. In a cell with points that are
    /// not free (it may lie on both sides of a wall), the straight line to the goal is the bound.
    #[inline]
    pub fn lower_bound(&self, p: Point2<f64>) -> f64 {
        let line = (self.goal - p).norm();
        let frame = self.inner.space.shapes().frame();
        let Some((col, row)) = frame.cell_at(p) else {
            return if line.is_finite() { line } else { 0.0 };
        };
        let Some(cell) = self.cells.get(frame.index(col, row)) else {
            return line;
        };
        let center = frame.center(col, row);
        let mut bits = cell.load(Ordering::Relaxed);
        if bits == UNKNOWN {
            bits = self.at_center(center).to_bits();
            // All threads compute the same value.
            cell.store(bits, Ordering::Relaxed);
        }
        // At least the straight line, which also covers `MIXED`.
        (f64::from(f32::from_bits(bits)) - (p - center).norm()).max(line)
    }

    /// The stored value of a cell: the distance from its centre, rounded down.
    fn at_center(&self, center: Point2<f64>) -> f32 {
        // The whole cell has this clearance.
        if self.inner.space.shapes().clearance_at_least(center) < self.inner.radius {
            return MIXED;
        }
        match self.distance(center) {
            Some(distance) => (distance as f32).next_down(),
            None => f32::INFINITY,
        }
    }
}

/// Cost (m) from a position on a track to the goal without another departure.
#[inline]
fn arrival(inner: &Inner, last: &[Option<(f64, f64)>], track: u32, at: f64) -> Option<f64> {
    let (departs, length) = (*last.get(track as usize)?)?;
    let arc = inner.graph.arc(track, at, departs)?;
    Some(inner.graph.site(track).radius * arc + length)
}
