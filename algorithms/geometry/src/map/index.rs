//! Spatial index of the pieces of the map.
//!
//! The map is divided into square buckets. For each bucket the index lists three sets of pieces.
//! Those that touch the bucket are what a ray can hit inside. Those that can be nearest to some
//! point of it make the exact distance cheap. Those within reach of it are what a moving robot can
//! hit.

use nalgebra::Point2;

use crate::grid::GridFrame;
use crate::shape::{Aabb, Convex};

/// Cells along the side of a bucket, unless the map is so large that buckets would be too many.
const CELLS_PER_BUCKET: usize = 4;
/// Number of buckets above which they are enlarged.
const MAX_BUCKETS: usize = 1 << 18;
/// Reach of a bucket's last list, in sides of a bucket.
const REACH: f64 = 2.0;
/// Tolerance of comparisons of distances (m): far above rounding, far below any relevant length.
const SLACK: f64 = 1e-9;

/// Distance (m) from a point to the edge of the map; negative beyond it, NaN for a NaN point.
pub fn edge_distance(bounds: &Aabb, p: Point2<f64>) -> f64 {
    let (low, high) = (p - bounds.min, bounds.max - p);
    let (x, y) = (low.x.min(high.x), low.y.min(high.y));
    // `f64::min` would drop a NaN.
    if y >= x || x.is_nan() { x } else { y }
}

/// The lists of one bucket, consecutive in [`ShapeIndex::items`].
#[derive(Debug, Clone, Copy, Default)]
struct Span {
    start: u32,
    touching_end: u32,
    nearest_end: u32,
    reach_end: u32,
}

/// Index of pieces by buckets; see the module.
#[derive(Debug, Clone)]
pub struct ShapeIndex {
    /// The buckets as cells of a grid.
    pub frame: GridFrame,
    /// Number of cells of the map's grid along the side of a bucket.
    pub cells_per_bucket: usize,
    /// Radius around any point of a bucket within which [`Self::within_reach`] is complete (m).
    pub reach: f64,
    inverse_side: f64,
    spans: Vec<Span>,
    items: Vec<u32>,
}

impl ShapeIndex {
    /// Builds the index of pieces for a map's grid.
    pub fn new(grid: GridFrame, bounds: Aabb, parts: &[Convex]) -> Self {
        let mut k = CELLS_PER_BUCKET;
        while grid.width.div_ceil(k) * grid.height.div_ceil(k) > MAX_BUCKETS {
            k *= 2;
        }
        let frame = GridFrame {
            width: grid.width.div_ceil(k),
            height: grid.height.div_ceil(k),
            resolution: grid.resolution * k as f64,
            origin: grid.origin,
        };
        let mut index = Self {
            frame,
            cells_per_bucket: k,
            reach: REACH * frame.resolution,
            inverse_side: 1.0 / frame.resolution,
            spans: vec![Span::default(); frame.len()],
            items: Vec::new(),
        };
        let all: Vec<u32> = (0..parts.len() as u32).collect();
        let node = Node {
            cols: (0, frame.width),
            rows: (0, frame.height),
        };
        index.divide(node, &all, bounds, parts);
        index
    }

    /// Distributes the candidates of a node of buckets to its halves, down to single buckets.
    fn divide(&mut self, node: Node, candidates: &[u32], bounds: Aabb, parts: &[Convex]) {
        let (center, half_diagonal) = node.disc(&self.frame);
        let distances: Vec<f64> = candidates
            .iter()
            .map(|&i| parts[i as usize].distance(center))
            .collect();
        let smallest = distances.iter().copied().fold(f64::INFINITY, f64::min);
        let nearest = smallest.min(edge_distance(&bounds, center).max(0.0));
        // By the triangle inequality a piece farther from the centre than this is nowhere in the
        // node the nearest one, nor within reach of it.
        let limit_nearest = nearest + 2.0 * half_diagonal + SLACK;
        let limit_reach = half_diagonal + self.reach + SLACK;
        let limit = limit_nearest.max(limit_reach);
        let kept = || {
            candidates
                .iter()
                .zip(&distances)
                .filter(|(_, d)| **d <= limit)
        };
        if let Some(halves) = node.halves() {
            let kept: Vec<u32> = kept().map(|(&i, _)| i).collect();
            for half in halves {
                self.divide(half, &kept, bounds, parts);
            }
            return;
        }
        // A single bucket: its lists, in the order touching, nearest, within reach.
        let limit_touching = half_diagonal + SLACK;
        let limit_nearest = limit_nearest.max(limit_touching);
        let start = self.items.len() as u32;
        let mut list = |low: f64, high: f64| {
            let listed = kept().filter(|(_, d)| **d > low && **d <= high);
            self.items.extend(listed.map(|(&i, _)| i));
            self.items.len() as u32
        };
        let touching_end = list(f64::NEG_INFINITY, limit_touching);
        let nearest_end = list(limit_touching, limit_nearest);
        let reach_end = list(limit_nearest, f64::INFINITY);
        let bucket = self.frame.index(node.cols.0, node.rows.0);
        self.spans[bucket] = Span {
            start,
            touching_end,
            nearest_end,
            reach_end,
        };
    }

    /// The bucket (column, row) of a point; the nearest one for a point outside.
    pub fn bucket_at(&self, p: Point2<f64>) -> (usize, usize) {
        // A float cast saturates, and takes NaN to 0.
        let col = ((p.x - self.frame.origin.x) * self.inverse_side) as usize;
        let row = ((p.y - self.frame.origin.y) * self.inverse_side) as usize;
        (
            col.min(self.frame.width - 1),
            row.min(self.frame.height - 1),
        )
    }

    fn span_at(&self, p: Point2<f64>) -> Span {
        let (col, row) = self.bucket_at(p);
        self.spans[row * self.frame.width + col]
    }

    /// The pieces that touch a bucket.
    pub fn touching(&self, col: usize, row: usize) -> &[u32] {
        let span = self.spans[row * self.frame.width + col];
        &self.items[span.start as usize..span.touching_end as usize]
    }

    /// The pieces that contain the nearest one to any point of a bucket, unless the edge of the map
    /// is nearer.
    pub fn nearest_in(&self, col: usize, row: usize) -> &[u32] {
        let span = self.spans[row * self.frame.width + col];
        &self.items[span.start as usize..span.nearest_end as usize]
    }

    /// The pieces that contain the nearest one to a point, unless the edge of the map is nearer.
    pub fn nearest(&self, p: Point2<f64>) -> &[u32] {
        let span = self.span_at(p);
        &self.items[span.start as usize..span.nearest_end as usize]
    }

    /// All pieces within `reach` of a point, and some beyond.
    pub fn within_reach(&self, p: Point2<f64>) -> &[u32] {
        let span = self.span_at(p);
        &self.items[span.start as usize..span.reach_end as usize]
    }
}

/// A block of buckets, half-open.
#[derive(Debug, Clone, Copy)]
struct Node {
    cols: (usize, usize),
    rows: (usize, usize),
}

impl Node {
    /// The circumscribed disc: centre and radius (m).
    fn disc(&self, frame: &GridFrame) -> (Point2<f64>, f64) {
        let side = frame.resolution;
        let x = (self.cols.0 + self.cols.1) as f64 * 0.5 * side;
        let y = (self.rows.0 + self.rows.1) as f64 * 0.5 * side;
        let (w, h) = (self.width() as f64 * side, self.height() as f64 * side);
        let center = Point2::new(frame.origin.x + x, frame.origin.y + y);
        (center, 0.5 * (w * w + h * h).sqrt())
    }

    fn width(&self) -> usize {
        self.cols.1 - self.cols.0
    }

    fn height(&self) -> usize {
        self.rows.1 - self.rows.0
    }

    /// The two halves across the longer side; `None` for a single bucket.
    fn halves(&self) -> Option<[Self; 2]> {
        if self.width() * self.height() <= 1 {
            return None;
        }
        let (mut low, mut high) = (*self, *self);
        if self.width() >= self.height() {
            let middle = self.cols.0 + self.width() / 2;
            low.cols.1 = middle;
            high.cols.0 = middle;
        } else {
            let middle = self.rows.0 + self.height() / 2;
            low.rows.1 = middle;
            high.rows.0 = middle;
        }
        Some([low, high])
    }
}
