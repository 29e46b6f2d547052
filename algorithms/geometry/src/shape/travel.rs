//! Distance of a moving point from a piece: along a segment, along an arc.

use nalgebra::{Point2, Vector2};

use super::convex::{Aabb, Convex, Edge};

/// An arc of a circle, counter-clockwise, of at most a half turn.
///
/// ```
/// use geometry::shape::{Convex, ShortArc};
/// use nalgebra::{Point2, Vector2};
///
/// // A quarter turn to the left of a robot that starts at (0, 0) and looks along +x.
/// let turn = ShortArc {
///     center: Point2::new(0.0, 1.0),
///     radius: 1.0,
///     start: -Vector2::y(),
///     end: Vector2::x(),
/// };
/// let pillar = Convex::disc(Point2::new(2.0, 0.0), 0.5);
/// assert!(pillar.arc_is_clear(&turn, 0.3));
/// assert!(!pillar.arc_is_clear(&turn, 1.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShortArc {
    /// Centre of the circle (m).
    pub center: Point2<f64>,
    /// Radius of the circle (m), ≥ 0.
    pub radius: f64,
    /// Unit vector from the centre to the start of the arc.
    pub start: Vector2<f64>,
    /// Unit vector from the centre to the end of the arc, at most a half turn counter-clockwise from
    /// `start`.
    pub end: Vector2<f64>,
}

impl ShortArc {
    /// The point of the circle in the direction of a unit vector (m).
    pub fn at(&self, direction: Vector2<f64>) -> Point2<f64> {
        self.center + direction * self.radius
    }

    /// The unit vector to the middle of the arc.
    pub fn middle(&self) -> Vector2<f64> {
        let sum = self.start + self.end;
        let norm = sum.norm();
        // The sum vanishes at a half turn, and is noise just below it.
        if norm > 1e-6 {
            sum / norm
        } else {
            Vector2::new(-self.start.y, self.start.x)
        }
    }

    /// Returns `true` if a direction from the centre (of any length) meets the arc.
    pub(crate) fn spans(&self, direction: Vector2<f64>) -> bool {
        // The last condition excludes the direction opposite to a very short arc.
        self.start.perp(&direction) >= 0.0
            && direction.perp(&self.end) >= 0.0
            && direction.dot(&(self.start + self.end)) >= 0.0
    }

    /// Distance (m) from a point to the arc, apart from the arc's ends: infinite if the nearest
    /// point of the circle is not on the arc.
    fn inner_distance(&self, p: Point2<f64>) -> f64 {
        let offset = p - self.center;
        if self.spans(offset) {
            (offset.norm() - self.radius).abs()
        } else {
            f64::INFINITY
        }
    }
}

impl Convex {
    /// Corners of the piece (m), counter-clockwise; the centre alone of a disc.
    pub fn corners(&self) -> Vec<Point2<f64>> {
        match self {
            Self::Disc { center, .. } => vec![*center],
            _ => self.with_edges(|edges| edges.iter().map(|e| e.start).collect()),
        }
    }

    /// Calls a function with the sides; none for a disc.
    fn with_edges<R>(&self, f: impl FnOnce(&[Edge]) -> R) -> R {
        match self {
            Self::Disc { .. } => f(&[]),
            Self::Box(aabb) => f(&box_edges(aabb)),
            Self::Polygon(edges) => f(edges),
        }
    }

    /// Returns `true` if every point of the segment from `a` to `b` is at least `radius` (m) away.
    ///
    /// Exact except for rounding. For a radius of 0 a segment along the border is clear, one through
    /// the inside is not.
    pub fn segment_is_clear(&self, a: Point2<f64>, b: Point2<f64>, radius: f64) -> bool {
        match self {
            Self::Disc { center, radius: r } => {
                let reach = r + radius;
                segment_distance_squared(*center, a, b) >= reach * reach
            }
            Self::Box(aabb) => {
                // Behind one of the four sides: by far the most frequent case.
                let (low, high) = (a.inf(&b), a.sup(&b));
                low.x - aabb.max.x >= radius
                    || aabb.min.x - high.x >= radius
                    || low.y - aabb.max.y >= radius
                    || aabb.min.y - high.y >= radius
                    || polygon_is_clear(&box_edges(aabb), a, b, radius)
            }
            Self::Polygon(edges) => polygon_is_clear(edges, a, b, radius),
        }
    }

    /// Distance (m) from the piece to the segment from `a` to `b`; 0 if they meet.
    #[cfg(test)]
    fn segment_distance(&self, a: Point2<f64>, b: Point2<f64>) -> f64 {
        match self {
            Self::Disc { center, radius } => {
                (segment_distance_squared(*center, a, b).sqrt() - radius).max(0.0)
            }
            _ => self.with_edges(|edges| {
                if meets(edges, a, b) {
                    return 0.0;
                }
                let ends = self.distance(a).min(self.distance(b));
                let corners = edges
                    .iter()
                    .map(|e| segment_distance_squared(e.start, a, b));
                ends.min(corners.fold(f64::INFINITY, f64::min).sqrt())
            }),
        }
    }

    /// Returns `true` if every point of an arc is at least `radius` (m) away.
    ///
    /// Exact except for rounding: the distance to a convex piece is minimal at an end of the arc, where
    /// the arc faces a corner, where it runs parallel to a side, or where it enters. An arc that
    /// touches is not clear at a radius of 0.
    pub fn arc_is_clear(&self, arc: &ShortArc, radius: f64) -> bool {
        let is_clear = |p: Point2<f64>| self.distance(p) >= radius;
        if !(is_clear(arc.at(arc.start)) && is_clear(arc.at(arc.end))) {
            return false;
        }
        match self {
            Self::Disc { center, radius: r } => arc.inner_distance(*center) >= r + radius,
            _ => self.with_edges(|edges| {
                edges.iter().all(|edge| {
                    let normal = edge.outward();
                    let parallel = [normal, -normal];
                    arc.inner_distance(edge.start) >= radius
                        && !crosses(arc, edge)
                        && parallel
                            .iter()
                            .all(|&n| !arc.spans(n) || is_clear(arc.at(n)))
                })
            }),
        }
    }
}

/// The sides of a rectangle.
fn box_edges(aabb: &Aabb) -> [Edge; 4] {
    let size = aabb.max - aabb.min;
    let side = |x: f64, y: f64, along: Vector2<f64>, length: f64| Edge {
        start: Point2::new(x, y),
        along,
        length,
    };
    let (x, y) = (Vector2::x(), Vector2::y());
    [
        side(aabb.min.x, aabb.min.y, x, size.x),
        side(aabb.max.x, aabb.min.y, y, size.y),
        side(aabb.max.x, aabb.max.y, -x, size.x),
        side(aabb.min.x, aabb.max.y, -y, size.y),
    ]
}

/// Square of the distance (m²) from a point to the segment from `a` to `b`.
fn segment_distance_squared(p: Point2<f64>, a: Point2<f64>, b: Point2<f64>) -> f64 {
    let (line, offset) = (b - a, p - a);
    let along = offset.dot(&line);
    let squared = line.norm_squared();
    if along <= 0.0 {
        offset.norm_squared()
    } else if along >= squared {
        (p - b).norm_squared()
    } else {
        // From the cross product: the difference of squares would lose the digits that decide.
        let beside = offset.perp(&line);
        beside * beside / squared
    }
}

/// Returns `true` if a segment keeps `radius` from the polygon with these sides.
fn polygon_is_clear(edges: &[Edge], a: Point2<f64>, b: Point2<f64>, radius: f64) -> bool {
    let behind = |edge: &Edge| {
        let normal = edge.outward();
        (a - edge.start).dot(&normal) >= radius && (b - edge.start).dot(&normal) >= radius
    };
    if edges.iter().any(behind) {
        return true;
    }
    let Some(beside) = side_gap(edges, a, b) else {
        return false;
    };
    if beside >= radius {
        return true;
    }
    // The remaining cases are near a corner, or blocked.
    let squared = radius.max(0.0) * radius.max(0.0);
    edges
        .iter()
        .all(|e| segment_distance_squared(e.start, a, b) >= squared)
        && !meets(edges, a, b)
        && [a, b].iter().all(|&p| point_is_clear(edges, p, squared))
}

/// Distance (m) of the polygon from the line through `a` and `b`; negative if it lies on both sides; −∞
/// for a segment without direction, `None` for one that is not finite.
fn side_gap(edges: &[Edge], a: Point2<f64>, b: Point2<f64>) -> Option<f64> {
    let line = b - a;
    let length = line.norm();
    if !length.is_finite() {
        return None;
    }
    if length == 0.0 {
        return Some(f64::NEG_INFINITY);
    }
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for edge in edges {
        let side = line.perp(&(edge.start - a)) / length;
        low = low.min(side);
        high = high.max(side);
    }
    Some(low.max(-high))
}

/// Returns `true` if a segment goes through the inside of the polygon (touching is not enough).
fn meets(edges: &[Edge], a: Point2<f64>, b: Point2<f64>) -> bool {
    let behind = |edge: &Edge| {
        let normal = edge.outward();
        (a - edge.start).dot(&normal) >= 0.0 && (b - edge.start).dot(&normal) >= 0.0
    };
    !edges.iter().any(behind) && side_gap(edges, a, b).is_none_or(|gap| gap < 0.0)
}

/// Returns `true` if the square of the distance from a point to the polygon is at least `squared` (m²),
/// corners apart.
fn point_is_clear(edges: &[Edge], p: Point2<f64>, squared: f64) -> bool {
    let mut inside = true;
    for edge in edges {
        let offset = p - edge.start;
        let height = offset.dot(&edge.outward());
        if height >= 0.0 {
            inside = false;
            let along = offset.dot(&edge.along);
            if along >= 0.0 && along <= edge.length && height * height < squared {
                return false;
            }
        }
    }
    !inside
}

/// Returns `true` if an arc meets a side.
fn crosses(arc: &ShortArc, edge: &Edge) -> bool {
    let offset = arc.center - edge.start;
    let height = offset.dot(&edge.outward());
    let half_chord = arc.radius * arc.radius - height * height;
    if half_chord < 0.0 {
        return false;
    }
    let (middle, half) = (offset.dot(&edge.along), half_chord.sqrt());
    [middle - half, middle + half].iter().any(|&along| {
        along >= 0.0
            && along <= edge.length
            && arc.spans(edge.start + edge.along * along - arc.center)
    })
}

#[cfg(test)]
mod tests;
