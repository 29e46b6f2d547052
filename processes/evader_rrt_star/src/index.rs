//! Nearest and near neighbours among points in the plane: a grid of buckets.
//!
//! The grid is rebuilt with finer cells whenever the number of points has quadrupled, so that a
//! bucket contains a point or two on average. `benches/planning.rs` compares it with a linear
//! search (`near_1500`).

use geometry::shape::Aabb;
use nalgebra::Point2;

const NONE: u32 = u32::MAX;

/// Maximum number of buckets along a side.
const MAX_SIDE: usize = 512;

/// Growing set of points; a point's number is its place in the order of insertion.
#[derive(Debug, Clone)]
pub struct BucketIndex {
    bounds: Aabb,
    columns: usize,
    rows: usize,
    /// Buckets per metre in each direction.
    per_metre: (f64, f64),
    heads: Vec<u32>,
    next: Vec<u32>,
    at: Vec<Point2<f64>>,
    /// Number of points at which the grid is rebuilt.
    full: usize,
}

/// Found point and its distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// The point's number.
    pub node: u32,
    /// Distance from the query place (m).
    pub distance: f64,
}

impl BucketIndex {
    /// Returns an index without points. Points outside `bounds` (m) may be inserted, too; queries
    /// for them are slower.
    pub fn new(bounds: Aabb) -> Self {
        let mut index = Self {
            bounds,
            columns: 1,
            rows: 1,
            per_metre: (0.0, 0.0),
            heads: Vec::new(),
            next: Vec::new(),
            at: Vec::new(),
            full: 0,
        };
        index.lay();
        index
    }

    /// Removes all points; keeps the memory.
    pub fn clear(&mut self) {
        self.next.clear();
        self.at.clear();
        self.lay();
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.at.len()
    }

    /// Returns `true` if there are no points.
    pub fn is_empty(&self) -> bool {
        self.at.is_empty()
    }

    /// Adds a point (m). A non-finite one takes a number, but is never found.
    pub fn insert(&mut self, p: Point2<f64>) {
        self.at.push(p);
        self.next.push(NONE);
        if self.at.len() > self.full {
            self.lay();
        } else {
            self.link(self.at.len() - 1);
        }
    }

    /// Moves a point to another place (m).
    pub fn relocate(&mut self, node: u32, to: Point2<f64>) {
        let Some(&from) = self.at.get(node as usize) else {
            return;
        };
        let (column, row) = self.bucket_of(from);
        let bucket = row * self.columns + column;
        let after = self.next.get(node as usize).copied().unwrap_or(NONE);
        if let Some(head) = self.heads.get_mut(bucket) {
            if *head == node {
                *head = after;
            } else {
                let mut before = *head;
                while let Some(next) = self.next.get_mut(before as usize) {
                    if *next == node {
                        *next = after;
                        break;
                    }
                    before = *next;
                }
            }
        }
        if let Some(at) = self.at.get_mut(node as usize) {
            *at = to;
        }
        self.link(node as usize);
    }

    /// Returns the points within `radius` (m) of `p`, in the order of the buckets.
    pub fn near(&self, p: Point2<f64>, radius: f64, found: &mut Vec<Neighbour>) {
        found.clear();
        let grow = nalgebra::Vector2::new(radius, radius);
        let (first_column, first_row) = self.bucket_of(p - grow);
        let (last_column, last_row) = self.bucket_of(p + grow);
        let squared = radius * radius;
        for row in first_row..=last_row {
            for column in first_column..=last_column {
                self.scan(row * self.columns + column, |node, at| {
                    let d = (at - p).norm_squared();
                    if d <= squared {
                        found.push(Neighbour {
                            node,
                            distance: d.sqrt(),
                        });
                    }
                });
            }
        }
    }

    /// Returns the point nearest to `p`; of several the one found first. `None` without points.
    pub fn nearest(&self, p: Point2<f64>) -> Option<Neighbour> {
        let (column, row) = self.bucket_of(p);
        // Width of the narrower side of a bucket: points in ring k are at least (k − 1) widths off.
        let width = 1.0 / self.per_metre.0.max(self.per_metre.1);
        let mut best = (f64::INFINITY, NONE);
        for ring in 0..self.columns.max(self.rows) {
            let unseen = (ring as f64 - 1.0) * width;
            if unseen > 0.0 && unseen * unseen > best.0 {
                break;
            }
            self.visit_ring(column, row, ring, |bucket| {
                self.scan(bucket, |node, at| {
                    let d = (at - p).norm_squared();
                    if d < best.0 {
                        best = (d, node);
                    }
                });
            });
        }
        (best.1 != NONE).then(|| Neighbour {
            node: best.1,
            distance: best.0.sqrt(),
        })
    }

    fn visit_ring(&self, column: usize, row: usize, ring: usize, mut visit: impl FnMut(usize)) {
        let (column, row, ring) = (column as i64, row as i64, ring as i64);
        let mut go = |c: i64, r: i64| {
            if (0..self.columns as i64).contains(&c) && (0..self.rows as i64).contains(&r) {
                visit(r as usize * self.columns + c as usize);
            }
        };
        for c in column - ring..=column + ring {
            go(c, row - ring);
            if ring > 0 {
                go(c, row + ring);
            }
        }
        for r in row - ring + 1..row + ring {
            go(column - ring, r);
            go(column + ring, r);
        }
    }

    fn scan(&self, bucket: usize, mut each: impl FnMut(u32, Point2<f64>)) {
        let mut node = self.heads.get(bucket).copied().unwrap_or(NONE);
        while let (Some(&at), Some(&next)) =
            (self.at.get(node as usize), self.next.get(node as usize))
        {
            each(node, at);
            node = next;
        }
    }

    /// Returns the bucket of a place; of the nearest one for places outside. NaN falls into the
    /// first.
    fn bucket_of(&self, p: Point2<f64>) -> (usize, usize) {
        let offset = p - self.bounds.min;
        // A cast saturates: values below 0 become 0.
        let column = (offset.x * self.per_metre.0) as usize;
        let row = (offset.y * self.per_metre.1) as usize;
        (column.min(self.columns - 1), row.min(self.rows - 1))
    }

    fn link(&mut self, node: usize) {
        let Some(&p) = self.at.get(node) else {
            return;
        };
        let (column, row) = self.bucket_of(p);
        if let Some(head) = self.heads.get_mut(row * self.columns + column) {
            if let Some(next) = self.next.get_mut(node) {
                *next = *head;
            }
            *head = node as u32;
        }
    }

    /// Rebuilds the grid for the present number of points.
    fn lay(&mut self) {
        let size = self.bounds.max - self.bounds.min;
        let (width, height) = (size.x.max(1e-9), size.y.max(1e-9));
        let wanted = self.at.len().max(64) as f64 * 2.0;
        let side = (width * height / wanted).sqrt();
        self.columns = ((width / side).ceil() as usize).clamp(1, MAX_SIDE);
        self.rows = ((height / side).ceil() as usize).clamp(1, MAX_SIDE);
        self.per_metre = (self.columns as f64 / width, self.rows as f64 / height);
        self.full = self.at.len().max(64) * 4;
        self.heads.clear();
        self.heads.resize(self.columns * self.rows, NONE);
        for node in 0..self.at.len() {
            self.link(node);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn bounds() -> Aabb {
        Aabb {
            min: Point2::new(-3.0, -1.0),
            max: Point2::new(5.0, 4.0),
        }
    }

    proptest! {
        #[test]
        fn the_grid_finds_what_a_search_through_all_points_finds(
            // Some lie outside the bounds.
            mut points in prop::collection::vec((-4.0..6.0, -2.0..5.0), 1..900),
            moves in prop::collection::vec((0_usize..900, -4.0..6.0, -2.0..5.0), 0..50),
            queries in prop::collection::vec((-4.0..6.0, -2.0..5.0, 0.0..3.0), 1..20),
        ) {
            let mut index = BucketIndex::new(bounds());
            for &(x, y) in &points {
                index.insert(Point2::new(x, y));
            }
            for (node, x, y) in moves {
                let node = node % points.len();
                points[node] = (x, y);
                index.relocate(node as u32, Point2::new(x, y));
            }
            prop_assert_eq!(index.len(), points.len());
            for (x, y, radius) in queries {
                let p = Point2::new(x, y);
                let distance = |&(x, y): &(f64, f64)| (Point2::new(x, y) - p).norm();
                let mut near = Vec::new();
                index.near(p, radius, &mut near);
                let mut found: Vec<u32> = near.iter().map(|n| n.node).collect();
                found.sort_unstable();
                let all: Vec<u32> = (0..points.len() as u32)
                    .filter(|&i| (Point2::from([points[i as usize].0, points[i as usize].1]) - p)
                        .norm_squared() <= radius * radius)
                    .collect();
                prop_assert_eq!(found, all);
                let nearest = index.nearest(p).unwrap();
                let least = points.iter().map(distance).fold(f64::INFINITY, f64::min);
                prop_assert_eq!(nearest.distance, least);
            }
        }
    }

    #[test]
    fn without_points_nothing_is_found() {
        let mut index = BucketIndex::new(bounds());
        assert!(index.is_empty());
        assert!(index.nearest(Point2::origin()).is_none());
        index.insert(Point2::new(1.0, 1.0));
        index.clear();
        assert!(index.nearest(Point2::origin()).is_none());
    }

    #[test]
    fn nan_places_are_ignored() {
        let mut index = BucketIndex::new(bounds());
        index.insert(Point2::new(f64::NAN, 1.0));
        index.insert(Point2::new(1.0, 1.0));
        let mut found = Vec::new();
        index.near(Point2::new(f64::NAN, 0.0), 1.0, &mut found);
        assert!(found.is_empty());
        assert!(index.nearest(Point2::new(f64::NAN, 0.0)).is_none());
        assert_eq!(index.nearest(Point2::new(-2.0, 0.0)).unwrap().node, 1);
    }
}
