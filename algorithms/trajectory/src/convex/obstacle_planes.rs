//! Half-planes that keep a path out of grown obstacles, and what is done where it is in one.

use geometry::shape::Contact;
use nalgebra::{Point2, Vector2};

use crate::convex::scaling::Scaling;

/// Depth (m) that is none.
pub const NO_DEPTH: f64 = 2e-5;

/// Growth of an obstacle beside the depth at which a path is in it (m).
const REPAIR: f64 = 1e-4;

/// A half-plane: the places with `normal` · place ≥ `line`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfPlane {
    /// Unit vector into the half-plane.
    pub normal: Vector2<f64>,
    /// Place of the border along the normal, in the units of its frame.
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

/// The point of the surface to which a contact of the place `p` belongs (m).
pub fn surface(p: Point2<f64>, contact: &Contact) -> Point2<f64> {
    p - contact.normal * contact.distance
}

/// Grows the margins (m) of the obstacles that a path is in, so that it stays out of them next
/// time; returns the largest depth (m) that is one, or 0.
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
