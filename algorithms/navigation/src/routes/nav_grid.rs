//! A coarse graph of the places where a robot fits.

use nalgebra::Point2;

use planner_view::map::PlannerMap;

/// Side of a graph's block (m), rounded to whole map cells. The graph may miss a passage narrower than
/// this (minus the robot's width).
const PITCH: f64 = 0.25;

/// Distance kept from obstacles beyond the robot's radius (m).
pub const MARGIN: f64 = 0.05;

/// Maximum length of the straight first leg of a route (m); the robot drives a longer straight leg in
/// parts. In the open, where routes bend only because the graph has eight directions, longer means
/// straighter and costs more time.
pub const SIGHT: f64 = 4.0;

/// Maximum number of blocks of a graph; above it the pitch is doubled until the graph fits.
const MAX_BLOCKS: usize = 1 << 20;

/// A node index that means "none".
pub const NONE: u32 = u32::MAX;

/// The eight neighbours of a block, in a fixed order.
const NEIGHBOURS: [(i64, i64); 8] = [
    (1, 0),
    (0, 1),
    (-1, 0),
    (0, -1),
    (1, 1),
    (-1, 1),
    (-1, -1),
    (1, -1),
];

/// A graph over blocks of map cells.
///
/// Each block is represented by its point with the most clearance (so that routes run along the
/// middle of streets); a block is a node if the robot fits there. Neighbouring nodes are joined if
/// the robot can travel straight between their points. Lengths are whole millimetres, so that sums
/// and ties are exact.
#[derive(Debug, Clone)]
pub struct NavGrid {
    width: usize,
    height: usize,
    pitch: f64,
    origin: Point2<f64>,
    inflation: f64,
    /// Per node, the point that represents it.
    points: Vec<Point2<f64>>,
    /// Per node, the index of its first edge in `edges`; one more entry for the end of the last.
    first_edge: Vec<u32>,
    edges: Vec<Edge>,
    /// Per block, the nearest node ([`NONE`] if the graph has no nodes).
    nearest: Vec<u32>,
}

/// An edge from one node to a neighbour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// The neighbour.
    pub to: u32,
    /// Length (mm), ≥ 1.
    pub length: u32,
}

impl NavGrid {
    /// Builds the graph for a robot of this radius (m).
    pub fn new(map: &PlannerMap, radius: f64) -> Self {
        let frame = &map.clearance_grid().frame;
        let inflation = radius + MARGIN;
        let mut stride = (PITCH / frame.resolution).round().max(1.0) as usize;
        while frame.width.div_ceil(stride) * frame.height.div_ceil(stride) > MAX_BLOCKS {
            stride *= 2;
        }
        let (width, height) = (frame.width.div_ceil(stride), frame.height.div_ceil(stride));
        let mut grid = Self {
            width,
            height,
            pitch: frame.resolution * stride as f64,
            origin: frame.origin,
            inflation,
            points: Vec::new(),
            first_edge: Vec::new(),
            edges: Vec::new(),
            nearest: vec![NONE; width * height],
        };
        let mut blocks = Vec::new();
        for row in 0..height {
            for col in 0..width {
                let (point, clearance) = grid.best_point(map, stride, col, row);
                if clearance >= inflation {
                    grid.nearest[row * width + col] = grid.points.len() as u32;
                    grid.points.push(point);
                    blocks.push(row * width + col);
                }
            }
        }
        grid.join(map, &blocks);
        grid.spread(blocks);
        grid
    }

    /// Distance kept from obstacles (m): the robot's radius and the margin.
    pub fn inflation(&self) -> f64 {
        self.inflation
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Returns `true` if the robot fits nowhere.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The node at, or nearest to, a point (m); a point outside the map is moved to the map's edge.
    /// `None` for a point that is not finite and in a map where the robot fits nowhere.
    pub fn node_at(&self, p: Point2<f64>) -> Option<usize> {
        if !(p.x.is_finite() && p.y.is_finite()) {
            return None;
        }
        let block = |value: f64, origin: f64, blocks: usize| {
            // Truncation rounds down here and, unlike `floor`, needs no call on the oldest x86-64.
            ((value - origin) / self.pitch).clamp(0.0, blocks as f64 - 1.0) as usize
        };
        let col = block(p.x, self.origin.x, self.width);
        let row = block(p.y, self.origin.y, self.height);
        let node = *self.nearest.get(row * self.width + col)?;
        (node != NONE).then_some(node as usize)
    }

    /// The point that represents a node (m).
    pub fn point(&self, node: usize) -> Option<Point2<f64>> {
        self.points.get(node).copied()
    }

    /// The points of all nodes (m).
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points
    }

    /// The routes from a node to its neighbours.
    pub fn edges(&self, node: usize) -> &[Edge] {
        match (self.first_edge.get(node), self.first_edge.get(node + 1)) {
            (Some(&first), Some(&end)) => self
                .edges
                .get(first as usize..end as usize)
                .unwrap_or_default(),
            _ => &[],
        }
    }

    /// The point of a block with the most clearance; of several, the one nearest the middle.
    fn best_point(
        &self,
        map: &PlannerMap,
        stride: usize,
        col: usize,
        row: usize,
    ) -> (Point2<f64>, f64) {
        let frame = &map.clearance_grid().frame;
        let middle = Point2::new(
            self.origin.x + (col as f64 + 0.5) * self.pitch,
            self.origin.y + (row as f64 + 0.5) * self.pitch,
        );
        let mut best = (middle, f64::NEG_INFINITY, f64::INFINITY);
        for fine_row in row * stride..((row + 1) * stride).min(frame.height) {
            for fine_col in col * stride..((col + 1) * stride).min(frame.width) {
                let point = frame.center(fine_col, fine_row);
                let cell = map
                    .clearance_grid()
                    .cells
                    .get(frame.index(fine_col, fine_row));
                let clearance = cell.map_or(0.0, |clearance| f64::from(*clearance));
                let off = (point - middle).norm_squared();
                if clearance > best.1 || (clearance == best.1 && off < best.2) {
                    best = (point, clearance, off);
                }
            }
        }
        (best.0, best.1)
    }

    /// Finds the edges between the nodes that stand for these blocks.
    fn join(&mut self, map: &PlannerMap, blocks: &[usize]) {
        for (node, &block) in blocks.iter().enumerate() {
            self.first_edge.push(self.edges.len() as u32);
            for (dx, dy) in NEIGHBOURS {
                let Some(other) = self.neighbour(block, dx, dy) else {
                    continue;
                };
                let to = self.nearest[other];
                if to == NONE {
                    continue;
                }
                let length = if (to as usize) < node {
                    // The other end has added this edge already; marching the other way might differ.
                    self.edges(to as usize)
                        .iter()
                        .find(|edge| edge.to as usize == node)
                        .map(|edge| edge.length)
                } else {
                    let (a, b) = (self.points[node], self.points[to as usize]);
                    map.line_is_clear(a, b, self.inflation)
                        .then(|| ((b - a).norm() * 1000.0).round().max(1.0) as u32)
                };
                self.edges.extend(length.map(|length| Edge { to, length }));
            }
        }
        self.first_edge.push(self.edges.len() as u32);
    }

    /// Gives every block without a node that of the nearest block with a node, ring by ring.
    fn spread(&mut self, mut front: Vec<usize>) {
        let mut at = 0;
        while at < front.len() {
            let block = front[at];
            at += 1;
            for (dx, dy) in NEIGHBOURS {
                if let Some(other) = self.neighbour(block, dx, dy)
                    && self.nearest[other] == NONE
                {
                    self.nearest[other] = self.nearest[block];
                    front.push(other);
                }
            }
        }
    }

    fn neighbour(&self, block: usize, dx: i64, dy: i64) -> Option<usize> {
        let col = (block % self.width) as i64 + dx;
        let row = (block / self.width) as i64 + dy;
        let inside = col >= 0 && row >= 0 && col < self.width as i64 && row < self.height as i64;
        inside.then(|| row as usize * self.width + col as usize)
    }
}
