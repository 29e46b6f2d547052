//! Convex pieces of obstacles, with the three basic queries: distance, nearest surface, ray.

use nalgebra::{Point2, Vector2};
use parry2d_f64::math::{Pose, Vector};
use parry2d_f64::shape::SharedShape;

use crate::math;

/// Distance (m) below which the direction from the surface to a point is rounding noise, and the
/// side's own normal is used.
const NORMAL_NOISE: f64 = 1e-12;

/// A solid convex piece in world coordinates.
///
/// ```
/// use geometry::shape::Convex;
/// use nalgebra::{Point2, Vector2};
///
/// let table = Convex::rectangle(Point2::new(3.0, 0.0), [1.0, 0.5], 0.0);
/// assert_eq!(table.distance(Point2::origin()), 2.0);
/// assert_eq!(table.contact(Point2::origin()).normal, -Vector2::x());
/// assert_eq!(table.ray(Point2::origin(), Vector2::x()), Some(2.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Convex {
    /// A disc.
    Disc {
        /// Centre (m).
        center: Point2<f64>,
        /// Radius (m).
        radius: f64,
    },
    /// An axis-aligned rectangle.
    Box(Aabb),
    /// A convex polygon.
    Polygon(Box<[Edge]>),
}

/// An axis-aligned rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Corner with the smallest coordinates (m).
    pub min: Point2<f64>,
    /// Corner with the largest coordinates (m).
    pub max: Point2<f64>,
}

/// A side of a convex polygon, counter-clockwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// Start of the side (m).
    pub(super) start: Point2<f64>,
    /// Unit vector along the side.
    pub(super) along: Vector2<f64>,
    /// Length of the side (m).
    pub(super) length: f64,
}

impl Edge {
    /// Unit vector out of the polygon.
    pub(super) fn outward(&self) -> Vector2<f64> {
        Vector2::new(self.along.y, -self.along.x)
    }
}

/// Position of a point relative to the nearest surface of a piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Distance to the surface (m); negative inside, by the depth.
    pub distance: f64,
    /// Unit vector from the surface to the outside at the nearest surface point. The whole piece
    /// lies behind the line through that point across `normal`.
    pub normal: Vector2<f64>,
}

impl Convex {
    /// A disc; `radius` (m) > 0.
    pub fn disc(center: Point2<f64>, radius: f64) -> Self {
        Self::Disc { center, radius }
    }

    /// A rectangle about `center` (m) with half its sides (m), turned by `angle` (rad).
    pub fn rectangle(center: Point2<f64>, half_extents: [f64; 2], angle: f64) -> Self {
        let half = Vector2::new(half_extents[0], half_extents[1]);
        if angle == 0.0 {
            return Self::Box(Aabb {
                min: center - half,
                max: center + half,
            });
        }
        let (sin, cos) = math::sincos(angle);
        let corner = |x: f64, y: f64| center + Vector2::new(cos * x - sin * y, sin * x + cos * y);
        Self::polygon(&[
            corner(-half.x, -half.y),
            corner(half.x, -half.y),
            corner(half.x, half.y),
            corner(-half.x, half.y),
        ])
    }

    /// A convex polygon from counter-clockwise corners (m); repeated corners are dropped.
    pub fn polygon(corners: &[Point2<f64>]) -> Self {
        let n = corners.len();
        let edges = (0..n).filter_map(|i| {
            let (start, end) = (corners[i], corners[(i + 1) % n]);
            let length = (end - start).norm();
            (length > 0.0).then(|| Edge {
                start,
                along: (end - start) / length,
                length,
            })
        });
        Self::Polygon(edges.collect())
    }

    /// Distance from a point to the piece (m); 0 inside.
    pub fn distance(&self, p: Point2<f64>) -> f64 {
        match self {
            Self::Disc { center, radius } => ((p - center).norm() - radius).max(0.0),
            Self::Box(aabb) => aabb.distance(p),
            Self::Polygon(_) => self.contact(p).distance.max(0.0),
        }
    }

    /// The nearest surface of a point inside or outside.
    pub fn contact(&self, p: Point2<f64>) -> Contact {
        match self {
            Self::Disc { center, radius } => {
                let offset = p - center;
                let norm = offset.norm();
                let normal = if norm > NORMAL_NOISE {
                    offset / norm
                } else {
                    Vector2::x()
                };
                Contact {
                    distance: norm - radius,
                    normal,
                }
            }
            Self::Box(aabb) => aabb.contact(p),
            Self::Polygon(edges) => polygon_contact(edges, p),
        }
    }

    /// Distance (m) along a ray from `origin` in the unit direction `dir` to the piece; 0 if the
    /// origin is inside, `None` if the ray misses.
    pub fn ray(&self, origin: Point2<f64>, dir: Vector2<f64>) -> Option<f64> {
        match self {
            Self::Disc { center, radius } => ray_disc(*center, *radius, origin, dir),
            Self::Box(aabb) => {
                let (enter, exit) = aabb.ray_interval(origin, dir);
                (enter <= exit && exit >= 0.0).then_some(enter.max(0.0))
            }
            Self::Polygon(edges) => {
                let (mut enter, mut exit) = (0.0f64, f64::INFINITY);
                for edge in edges {
                    let normal = edge.outward();
                    let height = (origin - edge.start).dot(&normal);
                    let rate = normal.dot(&dir);
                    if rate == 0.0 {
                        if height > 0.0 {
                            return None;
                        }
                    } else if rate < 0.0 {
                        enter = enter.max(-height / rate);
                    } else {
                        exit = exit.min(-height / rate);
                    }
                }
                (enter <= exit).then_some(enter)
            }
        }
    }

    /// The smallest axis-aligned rectangle around the piece.
    pub fn aabb(&self) -> Aabb {
        match self {
            Self::Disc { center, radius } => {
                let half = Vector2::new(*radius, *radius);
                Aabb {
                    min: center - half,
                    max: center + half,
                }
            }
            Self::Box(aabb) => *aabb,
            Self::Polygon(edges) => {
                let infinite = Point2::new(f64::INFINITY, f64::INFINITY);
                edges.iter().fold(
                    Aabb {
                        min: infinite,
                        max: -infinite,
                    },
                    |aabb, edge| Aabb {
                        min: aabb.min.inf(&edge.start),
                        max: aabb.max.sup(&edge.start),
                    },
                )
            }
        }
    }

    /// The piece as a parry shape with its position, for queries that need its general algorithms.
    pub fn to_parry(&self) -> (Pose, SharedShape) {
        match self {
            Self::Disc { center, radius } => (
                Pose::from_translation(Vector::new(center.x, center.y)),
                SharedShape::ball(*radius),
            ),
            Self::Box(aabb) => {
                let (center, half) = (aabb.center(), aabb.half_extents());
                (
                    Pose::from_translation(Vector::new(center.x, center.y)),
                    SharedShape::cuboid(half.x, half.y),
                )
            }
            Self::Polygon(edges) => {
                let corners: Vec<Vector> = edges
                    .iter()
                    .map(|e| Vector::new(e.start.x, e.start.y))
                    .collect();
                let shape = SharedShape::convex_polyline_unmodified(corners.clone())
                    // Corners on one line: parry requires a proper polygon; the hull of two of them
                    // is the same set of points.
                    .or_else(|| SharedShape::convex_hull(&corners))
                    .unwrap_or_else(|| SharedShape::polyline(corners, None));
                (Pose::IDENTITY, shape)
            }
        }
    }
}

impl Aabb {
    /// The middle (m).
    pub fn center(&self) -> Point2<f64> {
        nalgebra::center(&self.min, &self.max)
    }

    /// Half the lengths of the sides (m).
    pub fn half_extents(&self) -> Vector2<f64> {
        (self.max - self.min) * 0.5
    }

    /// Returns `true` if a point (m) lies inside or on the border.
    pub fn contains(&self, p: Point2<f64>) -> bool {
        p.x >= self.min.x && p.x <= self.max.x && p.y >= self.min.y && p.y <= self.max.y
    }

    /// Distance from a point to the rectangle (m); 0 inside.
    pub fn distance(&self, p: Point2<f64>) -> f64 {
        let dx = (self.min.x - p.x).max(p.x - self.max.x).max(0.0);
        let dy = (self.min.y - p.y).max(p.y - self.max.y).max(0.0);
        if dx == 0.0 {
            dy
        } else if dy == 0.0 {
            dx
        } else {
            (dx * dx + dy * dy).sqrt()
        }
    }

    /// The nearest surface of a point inside or outside.
    pub fn contact(&self, p: Point2<f64>) -> Contact {
        let (left, right) = (self.min.x - p.x, p.x - self.max.x);
        let (below, above) = (self.min.y - p.y, p.y - self.max.y);
        let (dx, nx) = if left > right {
            (left, -1.0)
        } else {
            (right, 1.0)
        };
        let (dy, ny) = if below > above {
            (below, -1.0)
        } else {
            (above, 1.0)
        };
        if dx > 0.0 && dy > 0.0 {
            let distance = (dx * dx + dy * dy).sqrt();
            if distance > NORMAL_NOISE {
                let normal = Vector2::new(nx * dx, ny * dy) / distance;
                return Contact { distance, normal };
            }
        }
        if dx > dy {
            Contact {
                distance: dx,
                normal: Vector2::new(nx, 0.0),
            }
        } else {
            Contact {
                distance: dy,
                normal: Vector2::new(0.0, ny),
            }
        }
    }

    /// Distances along a ray (unit direction) between which it is inside; empty (first > second)
    /// if it misses.
    pub fn ray_interval(&self, origin: Point2<f64>, dir: Vector2<f64>) -> (f64, f64) {
        let (mut enter, mut exit) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..2 {
            let (low, high) = (self.min[axis] - origin[axis], self.max[axis] - origin[axis]);
            if dir[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return (f64::INFINITY, f64::NEG_INFINITY);
                }
            } else {
                let (a, b) = (low / dir[axis], high / dir[axis]);
                enter = enter.max(a.min(b));
                exit = exit.min(a.max(b));
            }
        }
        (enter, exit)
    }
}

/// Distance along a ray (unit direction) to a disc; 0 inside, `None` if it misses.
pub fn ray_disc(
    center: Point2<f64>,
    radius: f64,
    origin: Point2<f64>,
    dir: Vector2<f64>,
) -> Option<f64> {
    let to_center = center - origin;
    let outside = to_center.norm_squared() - radius * radius;
    if outside <= 0.0 {
        return Some(0.0);
    }
    let nearest = to_center.dot(&dir);
    // The distance of the ray's line from the centre is computed from the cross product: the
    // difference of squares would lose the digits that decide a graze.
    let beside = to_center.perp(&dir);
    let half_chord = radius * radius - beside * beside;
    (nearest > 0.0 && half_chord >= 0.0).then(|| (nearest - half_chord.sqrt()).max(0.0))
}

fn polygon_contact(edges: &[Edge], p: Point2<f64>) -> Contact {
    let mut inside = Contact {
        distance: f64::NEG_INFINITY,
        normal: Vector2::x(),
    };
    let mut outside = Contact {
        distance: f64::INFINITY,
        normal: Vector2::x(),
    };
    let mut outside_squared = f64::INFINITY;
    for edge in edges {
        let normal = edge.outward();
        let offset = p - edge.start;
        let height = offset.dot(&normal);
        if height <= 0.0 {
            if height > inside.distance {
                inside = Contact {
                    distance: height,
                    normal,
                };
            }
            continue;
        }
        let t = offset.dot(&edge.along);
        let beyond = if t < 0.0 {
            t
        } else {
            (t - edge.length).max(0.0)
        };
        let squared = height * height + beyond * beyond;
        if squared < outside_squared {
            outside_squared = squared;
            outside = if beyond == 0.0 {
                Contact {
                    distance: height,
                    normal,
                }
            } else {
                let distance = squared.sqrt();
                let toward = normal * height + edge.along * beyond;
                let direction = if distance > NORMAL_NOISE {
                    toward / distance
                } else {
                    normal
                };
                Contact {
                    distance,
                    normal: direction,
                }
            };
        }
    }
    if outside_squared.is_finite() {
        outside
    } else {
        inside
    }
}

#[cfg(test)]
pub mod tests;
