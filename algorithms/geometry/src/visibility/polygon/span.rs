//! A wall as seen from the viewpoint, and directions in the order of the sweep.

use core::f64::consts::TAU;

use nalgebra::Vector2;

use crate::math;

/// A wall begins behind another if it does by more than this (m²), the area between them; otherwise
/// their distances decide.
const CLEARLY: f64 = 1e-9;

/// A wall as it is seen: from the viewpoint, its ends in directions relative to where the sweep begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    pub(super) begins: f64,
    /// Not before it begins: a wall over which the sweep begins is two spans.
    pub(super) ends: f64,
    pub(super) from: Vector2<f64>,
    pub(super) along: Vector2<f64>,
}

impl Span {
    /// Where on the wall a ray hits it, 0 to 1 from its beginning.
    pub(super) fn part(&self, ray: Vector2<f64>) -> f64 {
        (ray.perp(&self.from) / self.along.perp(&ray)).clamp(0.0, 1.0)
    }

    /// Whether a wall that begins in a direction of this one begins clearly behind it.
    pub(super) fn hides(&self, other: &Self) -> bool {
        (other.from - self.from).perp(&self.along) > CLEARLY
    }

    /// How far away the wall is in a direction.
    pub(super) fn distance(&self, ray: Vector2<f64>) -> f64 {
        self.from.perp(&self.along) / ray.perp(&self.along)
    }
}

/// An angle, mostly from a single turn, as one from 0 to 2π.
pub(super) fn from_begin(angle: f64) -> f64 {
    if angle > -TAU && angle < TAU {
        // The remainder, bit by bit, without dividing.
        if angle < 0.0 { angle + TAU } else { angle }
    } else {
        angle.rem_euclid(TAU)
    }
}

/// The unit vector at an angle (rad).
pub(super) fn direction(angle: f64) -> Vector2<f64> {
    let (sin, cos) = math::sincos(angle);
    Vector2::new(cos, sin)
}
