//! A wall relative to the viewpoint, and directions in the order of the sweep.

use core::f64::consts::TAU;

use nalgebra::Vector2;

use crate::math;

/// Area (m²) between two walls above which one is behind the other; otherwise their distances decide.
const CLEARLY: f64 = 1e-9;

/// A wall relative to the viewpoint, with the directions of its ends relative to the start of the
/// sweep.
#[derive(Debug, Clone, Copy)]
pub struct Span {
    pub(super) begins: f64,
    /// At least `begins`: a wall across the start of the sweep is two spans.
    pub(super) ends: f64,
    pub(super) from: Vector2<f64>,
    pub(super) along: Vector2<f64>,
}

impl Span {
    /// Position on the wall at which a ray hits it, 0 to 1 from its start.
    pub(super) fn part(&self, ray: Vector2<f64>) -> f64 {
        (ray.perp(&self.from) / self.along.perp(&ray)).clamp(0.0, 1.0)
    }

    /// Returns `true` if a wall that begins in a direction of this one begins clearly behind it.
    pub(super) fn hides(&self, other: &Self) -> bool {
        (other.from - self.from).perp(&self.along) > CLEARLY
    }

    /// Distance of the wall in a direction.
    pub(super) fn distance(&self, ray: Vector2<f64>) -> f64 {
        self.from.perp(&self.along) / ray.perp(&self.along)
    }
}

/// Reduces an angle, mostly from a single turn, to 0 … 2π.
pub fn from_begin(angle: f64) -> f64 {
    if angle > -TAU && angle < TAU {
        // The exact remainder, without a division.
        if angle < 0.0 { angle + TAU } else { angle }
    } else {
        angle.rem_euclid(TAU)
    }
}

/// The unit vector at an angle (rad).
pub fn direction(angle: f64) -> Vector2<f64> {
    let (sin, cos) = math::sincos(angle);
    Vector2::new(cos, sin)
}
