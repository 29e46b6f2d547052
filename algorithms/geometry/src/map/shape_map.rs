//! Convex pieces in a rectangle, prepared for exact queries.

use std::sync::Arc;

use super::field;
use super::index::ShapeIndex;
use super::passage::{KnownPassages, Passages};
use crate::grid::{Grid, GridFrame};
use crate::shape::{Aabb, Convex};

/// Convex pieces within a rectangle whose edge is a wall, with an index and a clearance field that
/// make exact queries cheap.
///
/// This is the geometry of a [`WorldMap`](super::WorldMap) without names, events and exits. A
/// planner that has received the pieces in a message gets the same results for the same queries.
///
/// ```
/// use geometry::grid::GridFrame;
/// use geometry::map::ShapeMap;
/// use geometry::shape::{Aabb, Convex};
/// use nalgebra::Point2;
///
/// let bounds = Aabb { min: Point2::origin(), max: Point2::new(4.0, 4.0) };
/// let frame = GridFrame { width: 40, height: 40, resolution: 0.1, origin: bounds.min };
/// let map = ShapeMap::new(vec![Convex::disc(Point2::new(3.0, 2.0), 0.5)], bounds, frame);
/// assert_eq!(map.distance(Point2::new(1.5, 2.0)), 1.0);
/// assert!(map.is_clear(Point2::new(1.0, 2.0), 0.9));
/// ```
#[derive(Debug, Clone)]
pub struct ShapeMap {
    pub(super) bounds: Aabb,
    pub(super) parts: Vec<Convex>,
    pub(super) index: ShapeIndex,
    occupancy: Grid<bool>,
    pub(super) clearance: Grid<f32>,
    pub(super) inverse_resolution: f64,
    /// Maximum error of the clearance of a cell for its points (m).
    pub(super) clearance_error: f64,
    passages: KnownPassages,
}

impl ShapeMap {
    /// Prepares pieces within `bounds` (m); `frame` is the grid of the clearance field and should
    /// begin at the smaller corner of the bounds and cover them. Finer cells make queries near
    /// walls cheaper and the preparation slower; the results are the same.
    pub fn new(parts: Vec<Convex>, bounds: Aabb, frame: GridFrame) -> Self {
        let index = ShapeIndex::new(frame, bounds, &parts);
        let (occupancy, clearance) = field::grids(frame, bounds, &parts, &index);
        // A point is at most half a diagonal from its cell's centre and distance changes by at most
        // the length of the move; the rounding of f32, relative to the largest value, is added.
        let largest = clearance.cells.iter().copied().fold(0.0, f32::max);
        let clearance_error = frame.resolution * core::f64::consts::FRAC_1_SQRT_2 * (1.0 + 1e-9)
            + f64::from(largest * f32::EPSILON)
            + 1e-9;
        Self {
            bounds,
            parts,
            index,
            occupancy,
            clearance,
            inverse_resolution: 1.0 / frame.resolution,
            clearance_error,
            passages: KnownPassages::default(),
        }
    }

    /// The rectangle; everything beyond it is solid.
    pub fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// The convex pieces.
    pub fn parts(&self) -> &[Convex] {
        &self.parts
    }

    /// Frame of the grids' cells.
    pub fn frame(&self) -> &GridFrame {
        &self.occupancy.frame
    }

    /// Per cell, `true` if its centre lies in a piece.
    pub fn occupancy(&self) -> &Grid<bool> {
        &self.occupancy
    }

    /// Per cell, the distance (m) from its centre to the nearest piece or the edge; 0 inside one.
    pub fn clearance(&self) -> &Grid<f32> {
        &self.clearance
    }

    /// The cells whose clearance is at least `needed` (m), with their connections; computed once.
    pub fn passages(&self, needed: f64) -> Arc<Passages> {
        self.passages.get(&self.clearance, needed)
    }

    /// Maximum error of the clearance of a cell for its points (m): half a diagonal and rounding.
    pub fn clearance_error(&self) -> f64 {
        self.clearance_error
    }
}
