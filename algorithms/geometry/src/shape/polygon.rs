//! Polygons: test of simplicity, and decomposition into convex parts.

use nalgebra::Point2;
use parameters::require;
use parry2d_f64::math::Vector;
use parry2d_f64::shape::TriMesh;
use parry2d_f64::transformation::hertel_mehlhorn;

use super::{Convex, Effort, MAX_CONCAVE_VERTICES, ShapeError};

/// The convex parts of a simple polygon in either orientation, whose corners are within their ranges.
pub fn convex_parts(vertices: &[[f64; 2]]) -> Result<Vec<Convex>, ShapeError> {
    let mut points: Vec<Point2<f64>> = vertices.iter().map(|v| Point2::new(v[0], v[1])).collect();
    reject_crossings(&points)?;
    let area = signed_area(&points);
    let size = extent(&points);
    if area.abs() <= 1e-12 * size * size {
        return Err(ShapeError::NoArea);
    }
    if area < 0.0 {
        points.reverse();
    }
    if is_convex(&points) {
        return Ok(vec![Convex::polygon(&points)]);
    }
    require(
        points.len() <= MAX_CONCAVE_VERTICES,
        "polygon.vertices",
        &format!("{} vertices of a polygon that is not convex", points.len()),
        format!("at most {MAX_CONCAVE_VERTICES}; divide it"),
    )?;
    let corners: Vec<Vector> = points.iter().map(|p| Vector::new(p.x, p.y)).collect();
    let mesh = TriMesh::from_polygon(corners).ok_or(ShapeError::NotDivisible)?;
    let mut covered = 0.0;
    let mut parts = Vec::new();
    for corners in hertel_mehlhorn(mesh.vertices(), mesh.indices()) {
        let part: Vec<Point2<f64>> = corners.iter().map(|c| Point2::new(c.x, c.y)).collect();
        let part_area = signed_area(&part);
        // Slivers without area result from collinear corners; the union does not need them.
        if part_area > 1e-15 * size * size {
            covered += part_area;
            parts.push(Convex::polygon(&part));
        }
    }
    // The parts do not overlap, so their areas show whether the decomposition is correct.
    if (covered - area.abs()).abs() > 1e-9 * area.abs() {
        return Err(ShapeError::NotDivisible);
    }
    Ok(parts)
}

/// The effort of [`convex_parts`].
pub fn effort(vertices: &[[f64; 2]]) -> Effort {
    let n = vertices.len();
    let mut points: Vec<Point2<f64>> = vertices.iter().map(|v| Point2::new(v[0], v[1])).collect();
    if signed_area(&points) < 0.0 {
        points.reverse();
    }
    Effort {
        pairs: n.saturating_mul(n),
        cuts: if is_convex(&points) {
            0
        } else {
            n.saturating_pow(3)
        },
    }
}

/// Shoelace area (m²), positive for counter-clockwise corners.
fn signed_area(points: &[Point2<f64>]) -> f64 {
    let Some(&origin) = points.first() else {
        return 0.0;
    };
    let mut sum = 0.0;
    for pair in points.windows(2) {
        sum += (pair[0] - origin).perp(&(pair[1] - origin));
    }
    0.5 * sum
}

/// Larger side of the bounding box (m).
fn extent(points: &[Point2<f64>]) -> f64 {
    let range = |f: fn(&Point2<f64>) -> f64| {
        let low = points.iter().map(f).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(f).fold(f64::NEG_INFINITY, f64::max);
        high - low
    };
    range(|p| p.x).max(range(|p| p.y))
}

/// Returns `true` if a simple counter-clockwise polygon turns left (or goes straight) at every corner.
fn is_convex(points: &[Point2<f64>]) -> bool {
    let n = points.len();
    (0..n).all(|i| {
        let (a, b, c) = (points[i], points[(i + 1) % n], points[(i + 2) % n]);
        (b - a).perp(&(c - b)) >= 0.0
    })
}

/// Finds two edges that cross, touch or overlap, other than neighbours at their shared vertex.
fn reject_crossings(points: &[Point2<f64>]) -> Result<(), ShapeError> {
    let n = points.len();
    let end = |i: usize| points[(i + 1) % n];
    for first in 0..n {
        for second in first + 1..n {
            let (a, b, c, d) = (points[first], end(first), points[second], end(second));
            let bad = if second == first + 1 {
                folds_back(a, b, d)
            } else if first == 0 && second == n - 1 {
                folds_back(c, a, b)
            } else {
                segments_meet(a, b, c, d)
            };
            if bad {
                return Err(ShapeError::SelfIntersecting { first, second });
            }
        }
    }
    Ok(())
}

/// Returns `true` if the path a → b → c returns onto itself at b (or stands still).
fn folds_back(a: Point2<f64>, b: Point2<f64>, c: Point2<f64>) -> bool {
    let (u, v) = (b - a, c - b);
    u == nalgebra::Vector2::zeros()
        || v == nalgebra::Vector2::zeros()
        || (u.perp(&v) == 0.0 && u.dot(&v) < 0.0)
}

/// Returns `true` if two closed segments have a point in common.
fn segments_meet(a: Point2<f64>, b: Point2<f64>, c: Point2<f64>, d: Point2<f64>) -> bool {
    let side = |p: Point2<f64>, q: Point2<f64>, r: Point2<f64>| (q - p).perp(&(r - p));
    let (abc, abd, cda, cdb) = (side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b));
    if abc * abd < 0.0 && cda * cdb < 0.0 {
        return true;
    }
    let on = |p: Point2<f64>, q: Point2<f64>, r: Point2<f64>| {
        r.x >= p.x.min(q.x) && r.x <= p.x.max(q.x) && r.y >= p.y.min(q.y) && r.y <= p.y.max(q.y)
    };
    (abc == 0.0 && on(a, b, c))
        || (abd == 0.0 && on(a, b, d))
        || (cda == 0.0 && on(c, d, a))
        || (cdb == 0.0 && on(c, d, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(vertices: &[[f64; 2]]) -> Result<Vec<Convex>, ShapeError> {
        convex_parts(vertices)
    }

    const ELL: [[f64; 2]; 6] = [
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];

    #[test]
    fn a_convex_polygon_is_its_own_part_in_either_orientation() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mut reversed = square;
        reversed.reverse();
        for vertices in [square, reversed] {
            let parts = parts(&vertices).unwrap();
            assert_eq!(parts.len(), 1);
            assert!((parts[0].distance(Point2::new(2.0, 0.5)) - 1.0).abs() < 1e-12);
            assert_eq!(parts[0].distance(Point2::new(0.5, 0.5)), 0.0);
        }
    }

    #[test]
    fn a_concave_polygon_keeps_its_notch() {
        let mut reversed = ELL;
        reversed.reverse();
        for vertices in [ELL, reversed] {
            let parts = parts(&vertices).unwrap();
            assert!(parts.len() >= 2);
            let distance = |x, y| {
                parts
                    .iter()
                    .map(|c| c.distance(Point2::new(x, y)))
                    .fold(f64::INFINITY, f64::min)
            };
            assert_eq!(distance(0.5, 0.5), 0.0);
            assert_eq!(distance(1.5, 0.5), 0.0);
            assert_eq!(distance(0.5, 1.5), 0.0);
            assert!((distance(1.5, 1.5) - 0.5).abs() < 1e-12);
        }
    }

    #[test]
    fn crossing_touching_and_folded_polygons_are_refused_with_their_edges() {
        let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        assert_eq!(
            parts(&bow).unwrap_err(),
            ShapeError::SelfIntersecting {
                first: 0,
                second: 2
            }
        );
        let touching = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]];
        assert!(matches!(
            parts(&touching),
            Err(ShapeError::SelfIntersecting { .. })
        ));
        let doubled = [[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        assert!(matches!(
            parts(&doubled),
            Err(ShapeError::SelfIntersecting { .. })
        ));
        let folded = [[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
        assert!(matches!(
            parts(&folded),
            Err(ShapeError::SelfIntersecting { .. })
        ));
        let flat = [[0.0, 0.0], [1.0, 0.0], [2.0, 1e-14]];
        assert_eq!(parts(&flat).unwrap_err(), ShapeError::NoArea);
    }
}
