//! Signed distance between a straight segment and a convex polygon.

use nalgebra::{Point2, Vector2};
use parry2d_f64::math::Vector;
use parry2d_f64::query::PointQuery;
use parry2d_f64::shape::Segment;

/// An edge and the half-plane behind it.
#[derive(Debug, Clone)]
struct Edge {
    segment: Segment,
    /// Unit normal, outwards.
    normal: Vector2<f64>,
    /// Coordinate of the edge along its normal (m).
    offset: f64,
}

/// A convex polygon, prepared for distances.
#[derive(Debug, Clone)]
pub struct ConvexPolygon {
    edges: Vec<Edge>,
}

impl ConvexPolygon {
    /// A polygon from corners (m) that [`validity`](crate::validity) has accepted.
    pub fn new(vertices: &[Point2<f64>]) -> Self {
        let ends = vertices.iter().skip(1).chain(vertices.first());
        let edges = vertices
            .iter()
            .zip(ends)
            .filter_map(|(a, b)| {
                let along = (b - a).try_normalize(0.0)?;
                let normal = Vector2::new(along.y, -along.x);
                Some(Edge {
                    segment: segment(*a, *b),
                    normal,
                    offset: normal.dot(&a.coords),
                })
            })
            .collect();
        Self { edges }
    }

    /// Distance (m) from the segment `a`–`b` to the polygon; where they overlap, minus the maximum
    /// depth of a point of the segment inside.
    pub fn distance(&self, a: Point2<f64>, b: Point2<f64>) -> f64 {
        let depth = self.least_signed(a, b);
        if depth <= 0.0 {
            return depth;
        }
        // Disjoint: the shortest connection touches a corner of one or an end of the other.
        let line = segment(a, b);
        self.edges.iter().fold(f64::INFINITY, |least, edge| {
            least
                .min(to_point(&line, edge.segment.a))
                .min(to_point(&edge.segment, line.a))
                .min(to_point(&edge.segment, line.b))
        })
    }

    /// The minimum, over the segment, of the maximum signed distance to an edge's line: minus the
    /// maximum depth if the segment meets the polygon, above 0 otherwise.
    ///
    /// Along the segment that maximum distance is a convex, piecewise linear function. The lines
    /// that are highest at two points around the minimum cross below it; the crossing either is the
    /// minimum, or finds a higher line. Stopped early, the result is too low: on the safe side.
    fn least_signed(&self, a: Point2<f64>, b: Point2<f64>) -> f64 {
        let along = b - a;
        let highest = |s: f64| {
            let point = a + along * s;
            let start = Line {
                s,
                value: f64::NEG_INFINITY,
                slope: 0.0,
            };
            self.edges.iter().fold(start, |highest, edge| {
                let value = edge.normal.dot(&point.coords) - edge.offset;
                if value > highest.value {
                    let slope = edge.normal.dot(&along);
                    Line { s, value, slope }
                } else {
                    highest
                }
            })
        };
        let (mut low, mut high) = (highest(0.0), highest(1.0));
        if low.slope >= 0.0 {
            return low.value;
        }
        if high.slope <= 0.0 {
            return high.value;
        }
        let mut crossing = f64::NEG_INFINITY;
        for _ in 0..=self.edges.len() {
            let ahead =
                (low.value - high.value + high.slope * (high.s - low.s)) / (high.slope - low.slope);
            let s = (low.s + ahead).clamp(low.s, high.s);
            crossing = low.value + low.slope * (s - low.s);
            let found = highest(s);
            if found.value <= crossing + 1e-12 {
                break;
            }
            if found.slope < 0.0 {
                low = found;
            } else {
                high = found;
            }
        }
        crossing
    }
}

/// A straight line through (`s`, `value`).
#[derive(Debug, Clone, Copy)]
struct Line {
    s: f64,
    value: f64,
    slope: f64,
}

/// The segment between two points (m).
pub fn segment(a: Point2<f64>, b: Point2<f64>) -> Segment {
    Segment::new(Vector::new(a.x, a.y), Vector::new(b.x, b.y))
}

/// Distance (m) from a segment to a point.
pub fn to_point(segment: &Segment, point: Vector) -> f64 {
    let nearest = segment.project_local_point(point, true).point;
    (point - nearest).length()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn square() -> ConvexPolygon {
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        ConvexPolygon::new(&corners.map(Point2::from))
    }

    fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
        square().distance(Point2::from(a), Point2::from(b))
    }

    #[test]
    fn segments_outside_have_the_distance_of_the_nearest_points() {
        assert!((distance([3.0, 0.5], [5.0, 0.5]) - 1.0).abs() < 1e-12);
        // An end beyond a corner; a segment across a corner; a segment along an edge.
        assert!((distance([3.0, 3.0], [9.0, 4.0]) - 2.0_f64.sqrt()).abs() < 1e-12);
        assert!((distance([2.0, 3.0], [3.0, 2.0]) - 0.5_f64.sqrt()).abs() < 1e-12);
        assert!((distance([-9.0, 2.5], [9.0, 2.5]) - 0.5).abs() < 1e-12);
        // A point.
        assert!((distance([3.0, 1.0], [3.0, 1.0]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn segments_through_have_their_greatest_depth() {
        assert!((distance([-9.0, 1.5], [9.0, 1.5]) + 0.5).abs() < 1e-12);
        assert!((distance([-1.0, 1.0], [1.0, -1.0])).abs() < 1e-12);
        assert!((distance([-1.0, -1.0], [0.25, 0.25]) + 0.25).abs() < 1e-12);
        assert!((distance([0.0, 0.0], [2.0, 2.0]) + 1.0).abs() < 1e-12);
        assert!((distance([1.0, 0.3], [1.0, 0.3]) + 0.3).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn agrees_with_the_least_over_many_points(
            corners in 3..9_u32, turned in 0.0..6.0_f64,
            ax in -3.0..3.0_f64, ay in -3.0..3.0_f64, bx in -3.0..3.0_f64, by in -3.0..3.0_f64,
        ) {
            let vertices: Vec<Point2<f64>> = (0..corners)
                .map(|k| turned + core::f64::consts::TAU * f64::from(k) / f64::from(corners))
                .map(|angle| Point2::new(1.5 * libm::cos(angle), libm::sin(angle)))
                .collect();
            let polygon = ConvexPolygon::new(&vertices);
            let (a, b) = (Point2::new(ax, ay), Point2::new(bx, by));
            let least = (0..=2000)
                .map(|k| a + (b - a) * (f64::from(k) / 2000.0))
                .map(|point| polygon.distance(point, point))
                .fold(f64::INFINITY, f64::min);
            let exact = polygon.distance(a, b);
            prop_assert!(exact <= least + 1e-9);
            prop_assert!(exact >= least - 0.5 * (b - a).norm() / 2000.0 - 1e-9);
        }
    }
}
