//! How plans shall be made, with lengths in pixels.

use nalgebra::Point2;
use serde::{Deserialize, Serialize};
use trajectory::options::{Constraints, Guess};
use trajectory::{Method, Options, ProblemError};

/// How plans shall be made; absent numbers are the optimiser's own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PlanOptions {
    /// The method.
    pub method: Method,
    /// From what path it starts.
    pub guess: Guess,
    /// Where along the curve obstacles are looked at.
    pub constraints: Constraints,
    /// Whether other ways are tried where the curve asked for is of no use.
    pub fallbacks: bool,
    /// Degree of the B-spline.
    pub degree: Option<usize>,
    /// Number of its control points.
    pub control_points: Option<usize>,
    /// N of the N + 1 Legendre–Gauss–Lobatto nodes.
    pub nodes: Option<usize>,
    /// Reference point of `vmc` (px).
    pub reference_point: Option<[f64; 2]>,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            method: Method::default(),
            guess: Guess::default(),
            constraints: Constraints::default(),
            fallbacks: true,
            degree: None,
            control_points: None,
            nodes: None,
            reference_point: None,
        }
    }
}

impl PlanOptions {
    /// The options as the optimiser takes them, for pixels of this size (m).
    pub fn scaled(&self, metres_per_px: f64) -> Options {
        let default = Options::default();
        Options {
            method: self.method,
            guess: self.guess,
            constraints: self.constraints,
            fallbacks: self.fallbacks,
            degree: self.degree,
            control_points: self.control_points,
            nodes: self.nodes.unwrap_or(default.nodes),
            reference_point: self
                .reference_point
                .map(|[x, y]| Point2::new(x * metres_per_px, y * metres_per_px)),
            ..default
        }
    }

    /// Checks what does not depend on the instance.
    ///
    /// # Errors
    /// [`ProblemError`] names the first option that is out of range.
    pub fn validate(&self) -> Result<(), ProblemError> {
        self.scaled(1.0).validate()
    }
}
