//! Inequalities of a problem, each g(w) ≤ 0 with at most two of the components of w = (s, u).

use geometry::shape::Convex;
use nalgebra::{Point2, Vector2};

use crate::riccati::Point;
use crate::variables::{TIME, X, Y};

/// A corner of a polygon nearer than this to the nearest point (in scaled units) is that point.
const CORNER: f64 = 1e-7;

/// An inequality of a node or stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Row {
    /// a wᵢ + b wⱼ ≤ limit.
    Linear {
        /// i and j.
        at: [usize; 2],
        /// a and b.
        factors: [f64; 2],
        /// The limit.
        limit: f64,
    },
    /// The position keeps its distance from an obstacle.
    Contact {
        /// Index of the obstacle.
        obstacle: usize,
    },
}

/// Value and derivatives of a row.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RowDerivatives {
    /// g.
    pub value: f64,
    /// Components.
    pub at: [usize; 2],
    /// Derivatives of g by them.
    pub slope: [f64; 2],
    /// g has the second derivative −`bend` across its slope.
    pub bend: f64,
}

/// An obstacle in scaled units.
#[derive(Debug, Clone, PartialEq)]
pub enum Obstacle {
    /// A disc, grown by the distance that is kept.
    Disc {
        /// Its centre.
        center: Point2<f64>,
        /// Its radius.
        radius: f64,
    },
    /// A polygon.
    Polygon {
        /// The polygon.
        shape: Convex,
        /// Its corners.
        corners: Vec<Point2<f64>>,
        /// The distance that is kept.
        keep: f64,
    },
}

impl Obstacle {
    /// An obstacle (m) from which the position keeps a distance (m).
    pub fn new(shape: &Convex, keep: f64, origin: Point2<f64>, length: f64) -> Self {
        let scaled = |p: Point2<f64>| Point2::from((p - origin) / length);
        if let Convex::Disc { center, radius } = shape {
            return Self::Disc {
                center: scaled(*center),
                radius: (radius + keep) / length,
            };
        }
        let corners: Vec<_> = shape.corners().into_iter().map(scaled).collect();
        Self::Polygon {
            shape: Convex::polygon(&corners),
            corners,
            keep: keep / length,
        }
    }

    /// Grows the obstacle by a distance.
    pub fn grow(&mut self, by: f64) {
        match self {
            Self::Disc { radius, .. } => *radius += by,
            Self::Polygon { keep, .. } => *keep += by,
        }
    }

    /// Distance that is left to the border; negative beyond it.
    pub fn distance(&self, p: Point2<f64>) -> f64 {
        -self.evaluate(p).value
    }

    fn evaluate(&self, p: Point2<f64>) -> RowDerivatives {
        let (value, normal, bend) = match self {
            Self::Disc { center, radius } => {
                let offset = p - center;
                let norm = offset.norm();
                let normal = if norm > 1e-12 {
                    offset / norm
                } else {
                    Vector2::x()
                };
                (radius - norm, normal, 1.0 / norm.max(1e-3 * radius))
            }
            Self::Polygon {
                shape,
                corners,
                keep,
            } => {
                let contact = shape.contact(p);
                let nearest = p - contact.normal * contact.distance;
                let corner = corners.iter().any(|c| (c - nearest).norm() < CORNER);
                let bend = if corner && contact.distance > CORNER {
                    1.0 / contact.distance
                } else {
                    0.0
                };
                (keep - contact.distance, contact.normal, bend)
            }
        };
        RowDerivatives {
            value,
            at: [X, Y],
            slope: [-normal.x, -normal.y],
            bend,
        }
    }
}

impl RowDerivatives {
    /// The constant derivatives of a row; the others, and the value, are 0.
    pub fn from_row(row: &Row) -> Self {
        match row {
            Row::Linear { at, factors, .. } => Self {
                at: *at,
                slope: *factors,
                ..Self::default()
            },
            Row::Contact { .. } => Self::default(),
        }
    }
}

impl Row {
    /// `factor` wᵢ ≤ limit.
    pub fn bound(i: usize, factor: f64, limit: f64) -> Self {
        Self::Linear {
            at: [i, i],
            factors: [factor, 0.0],
            limit,
        }
    }

    /// Sets value and derivatives at w.
    pub fn evaluate(&self, w: &Point, obstacles: &[Obstacle], to: &mut RowDerivatives) {
        match self {
            Self::Linear { .. } => to.value = self.value(w, obstacles),
            Self::Contact { obstacle } => {
                *to = obstacles[*obstacle].evaluate(Point2::new(w[X], w[Y]));
            }
        }
    }

    /// The same limit in another stage.
    pub fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (
                Self::Linear {
                    at: a, factors: f, ..
                },
                Self::Linear {
                    at: b, factors: g, ..
                },
            ) => a == b && f[0] == g[0] && (f[1] == g[1] || a[1] == TIME),
            (Self::Contact { obstacle: a }, Self::Contact { obstacle: b }) => a == b,
            _ => false,
        }
    }

    /// A limit of no other components than these.
    pub fn is_of(&self, component: impl Fn(usize) -> bool) -> bool {
        matches!(self, Self::Linear { at, .. } if at.iter().all(|&i| component(i)))
    }

    /// A limit of a change of speed in a stage.
    pub fn is_rate(&self) -> bool {
        matches!(self, Self::Linear { at: [_, TIME], .. })
    }

    /// g at w.
    pub fn value(&self, w: &Point, obstacles: &[Obstacle]) -> f64 {
        match self {
            Self::Linear { at, factors, limit } => {
                factors[0] * w[at[0]] + factors[1] * w[at[1]] - limit
            }
            Self::Contact { obstacle } => match &obstacles[*obstacle] {
                Obstacle::Disc { center, radius } => {
                    let (x, y) = (w[X] - center.x, w[Y] - center.y);
                    radius - (x * x + y * y).sqrt()
                }
                polygon @ Obstacle::Polygon { .. } => {
                    polygon.evaluate(Point2::new(w[X], w[Y])).value
                }
            },
        }
    }
}
