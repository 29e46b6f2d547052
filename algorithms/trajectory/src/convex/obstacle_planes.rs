//! Half-planes that keep a path out of grown obstacles, and the correction of penetrations.

use geometry::shape::Contact;
use nalgebra::{Point2, Vector2};

use crate::convex::scaling::Scaling;

/// Depth (m) that counts as none.
pub const NO_DEPTH: f64 = 2e-5;

/// Growth of an obstacle in addition to the penetration (m).
const REPAIR: f64 = 1e-4;

/// A half-plane: the points p with `normal` · p ≥ `line`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfPlane {
    /// Unit vector into the half-plane.
    pub normal: Vector2<f64>,
    /// Coordinate of the border along the normal, in the units of its frame.
    pub line: f64,
}

impl HalfPlane {
    /// The half-plane, in a frame's units, whose border is `keep` (m) ahead of a point of an
    /// obstacle's surface with this normal.
    pub fn ahead_of(
        surface: Point2<f64>,
        normal: Vector2<f64>,
        keep: f64,
        frame: &Scaling,
    ) -> Self {
        Self {
            normal,
            line: frame.inward(surface).dot(&normal) + keep / frame.unit(),
        }
    }
}

/// The point of the surface that belongs to a contact of the point `p` (m).
pub fn surface(p: Point2<f64>, contact: &Contact) -> Point2<f64> {
    p - contact.normal * contact.distance
}

/// Grows the margins (m) of the obstacles that a path penetrates, so that the next path avoids
/// them; returns the largest relevant depth (m), or 0.
pub fn grow_margins(depths: &[(usize, f64)], margins: &mut [f64]) -> f64 {
    let mut deepest: f64 = 0.0;
    for &(index, depth) in depths {
        if depth > NO_DEPTH {
            margins[index] += depth + REPAIR;
            deepest = deepest.max(depth);
        }
    }
    deepest
}
