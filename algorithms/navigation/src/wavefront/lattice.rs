//! The places where a disc robot fits, at a pitch.

use geometry::grid::GridFrame;
use nalgebra::Point2;

use planner_view::map::PlannerMap;

/// Index that means "no node".
pub const NONE: u32 = u32::MAX;

/// Maximum number of cells of a lattice; above it the pitch is doubled until the lattice fits.
const MAX_CELLS: usize = 1 << 22;

/// The free cells of a coarsened map, as nodes.
///
/// A cell is free if the robot fits with its centre in the cell's centre. Nodes are numbered row by
/// row, so that the same map gives the same numbers.
#[derive(Debug, Clone)]
pub struct Lattice {
    frame: GridFrame,
    radius: f64,
    /// Per cell, its node or [`NONE`].
    node_of: Vec<u32>,
    /// Per node, its cell.
    cell_of: Vec<u32>,
}

impl Lattice {
    /// Builds the lattice for a robot of this radius (m) at this pitch (m), rounded to whole cells of
    /// the map (at least one).
    pub fn new(map: &PlannerMap, pitch: f64, radius: f64) -> Self {
        let fine = &map.clearance_grid().frame;
        // A pitch that is not a number becomes one cell.
        let mut stride = (pitch / fine.resolution).round().max(1.0) as usize;
        while fine.width.div_ceil(stride) * fine.height.div_ceil(stride) > MAX_CELLS {
            stride *= 2;
        }
        let frame = GridFrame {
            width: fine.width.div_ceil(stride),
            height: fine.height.div_ceil(stride),
            resolution: fine.resolution * stride as f64,
            origin: fine.origin,
        };
        let mut node_of = vec![NONE; frame.len()];
        let mut cell_of = Vec::new();
        for row in 0..frame.height {
            for col in 0..frame.width {
                if map.clearance(frame.center(col, row)) >= radius {
                    let cell = frame.index(col, row);
                    node_of[cell] = cell_of.len() as u32;
                    cell_of.push(cell as u32);
                }
            }
        }
        Self {
            frame,
            radius,
            node_of,
            cell_of,
        }
    }

    /// Number of free cells.
    pub fn len(&self) -> usize {
        self.cell_of.len()
    }

    /// Returns `true` if the robot fits nowhere.
    pub fn is_empty(&self) -> bool {
        self.cell_of.is_empty()
    }

    /// Frame of the cells.
    pub fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// Side of a cell (m).
    pub fn pitch(&self) -> f64 {
        self.frame.resolution
    }

    /// Radius of the robot (m).
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The node of the cell that contains a point (m), if the cell is free.
    pub fn node_at(&self, p: Point2<f64>) -> Option<usize> {
        let node = *self.node_of.get(self.frame.index_at(p)?)?;
        (node != NONE).then_some(node as usize)
    }

    /// The node of a cell by its index in [`Lattice::frame`], if the cell is free.
    pub fn node_of_cell(&self, cell: usize) -> Option<usize> {
        let node = *self.node_of.get(cell)?;
        (node != NONE).then_some(node as usize)
    }

    /// The cell of a node, as an index in [`Lattice::frame`].
    pub fn cell(&self, node: usize) -> Option<usize> {
        self.cell_of.get(node).map(|&cell| cell as usize)
    }

    /// Centre of a node's cell (m).
    pub fn point(&self, node: usize) -> Option<Point2<f64>> {
        let cell = self.cell(node)?;
        Some(
            self.frame
                .center(cell % self.frame.width, cell / self.frame.width),
        )
    }

    /// The node `dx` columns and `dy` rows further, if that cell is free.
    pub fn beside(&self, node: usize, dx: i64, dy: i64) -> Option<usize> {
        let cell = self.cell(node)?;
        let col = (cell % self.frame.width) as i64 + dx;
        let row = (cell / self.frame.width) as i64 + dy;
        let inside =
            col >= 0 && row >= 0 && col < self.frame.width as i64 && row < self.frame.height as i64;
        if !inside {
            return None;
        }
        self.node_of_cell(self.frame.index(col as usize, row as usize))
    }

    /// The free cell nearest to a point among those whose centre is within `reach` (m) of it; of
    /// equally near ones, the lowest number.
    pub fn nearest(&self, p: Point2<f64>, reach: f64) -> Option<usize> {
        let mut best: Option<(f64, usize)> = None;
        self.for_each_within(p, reach, |node, distance| {
            if best.is_none_or(|(least, _)| distance < least) {
                best = Some((distance, node));
            }
        });
        best.map(|(_, node)| node)
    }

    /// Calls `visit` with every node whose centre is within `reach` (m) of a point, and the
    /// distance (m), row by row.
    pub fn for_each_within(&self, p: Point2<f64>, reach: f64, mut visit: impl FnMut(usize, f64)) {
        let frame = &self.frame;
        let near = |value: f64, origin: f64, cells: usize| {
            // A cast of a float saturates; NaN gives an empty range below.
            let low = ((value - reach - origin) / frame.resolution - 0.5).ceil();
            let high = ((value + reach - origin) / frame.resolution - 0.5).floor();
            if low.is_nan() || high.is_nan() || high < 0.0 {
                0..0
            } else {
                low.max(0.0) as usize..(high as usize).saturating_add(1).min(cells)
            }
        };
        let cols = near(p.x, frame.origin.x, frame.width);
        for row in near(p.y, frame.origin.y, frame.height) {
            for col in cols.clone() {
                let node = self.node_of.get(frame.index(col, row)).copied();
                let Some(node) = node.filter(|&node| node != NONE) else {
                    continue;
                };
                let distance = (frame.center(col, row) - p).norm();
                if distance <= reach {
                    visit(node as usize, distance);
                }
            }
        }
    }

    /// Radius with which lines of sight are tested (m): half a cell's diagonal less than the robot's,
    /// so that rounding does not block a line along a wall at exactly the robot's radius.
    pub(super) fn sight_radius(&self, map: &PlannerMap) -> f64 {
        let slack = 0.71 * map.clearance_grid().frame.resolution;
        (self.radius - slack).max(0.5 * self.radius)
    }
}
