//! Coordinates of the programs.

use nalgebra::{Point2, Vector2};

/// Length of the guide in units of the programs: their numbers are about 1 at every scale.
pub const UNITS: f64 = 8.0;

/// Coordinates of the programs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scaling {
    origin: Point2<f64>,
    /// Metres per unit.
    unit: f64,
}

impl Scaling {
    /// Creates the coordinates for a path of this length (m) from this origin.
    pub fn new(origin: Point2<f64>, length: f64) -> Self {
        Self {
            origin,
            unit: length / UNITS,
        }
    }

    /// Converts a point (m) to the programs' coordinates.
    pub fn inward(&self, p: Point2<f64>) -> Vector2<f64> {
        (p - self.origin) / self.unit
    }

    /// Converts the programs' coordinates to a point (m).
    pub fn outward(&self, v: Vector2<f64>) -> Point2<f64> {
        self.origin + v * self.unit
    }

    /// Metres per unit.
    pub fn unit(&self) -> f64 {
        self.unit
    }
}
