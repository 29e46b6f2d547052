//! Half-planes that keep a path out of grown obstacles, and what is done where it is in one.

use nalgebra::{Point2, Vector2};
use sim_backend::shape::Contact;

use crate::ground::Ground;
use crate::path::PathPoint;
use crate::shape::Frame;

/// Depth [m] that is none.
pub const NO_DEPTH: f64 = 2e-5;

/// Growth of an obstacle beside the depth at which a path is in it [m].
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
    /// The half-plane, in a frame's units, whose border is `keep` [m] ahead of a point of an
    /// obstacle's surface with this normal.
    pub fn ahead_of(surface: Point2<f64>, normal: Vector2<f64>, keep: f64, frame: &Frame) -> Self {
        Self {
            normal,
            line: frame.inward(surface).dot(&normal) + keep / frame.unit(),
        }
    }
}

/// The point of the surface to which a contact of the place `p` belongs [m].
pub fn surface(p: Point2<f64>, contact: &Contact) -> Point2<f64> {
    p - contact.normal * contact.distance
}

/// Largest depth [m] of a path in each grown obstacle that it is in, by index.
pub fn depths(ground: &Ground, points: &[PathPoint]) -> Vec<(usize, f64)> {
    let mut found = Vec::new();
    for (index, obstacle) in ground.obstacles.iter().enumerate() {
        let mut least = f64::INFINITY;
        let mut i = 0;
        while i < points.len() {
            let distance = obstacle.contact(points[i].at).distance - ground.clearance;
            least = least.min(distance);
            // Distances change by no more than the way: so far ahead there is nothing deep.
            let reach = points[i].s + distance;
            i += 1;
            i += points[i..].partition_point(|p| p.s < reach);
        }
        if least < 0.0 {
            found.push((index, -least));
        }
    }
    found
}

/// Grows the margins [m] of the obstacles that a path is in, so that it stays out of them next
/// time; returns the largest depth [m] that is one, or 0.
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
