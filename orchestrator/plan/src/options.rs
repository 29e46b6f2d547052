//! Options of the planner, with lengths in pixels.

use curves::bspline_basis::MAX_DEGREE;
use curves::lgl_nodes::MAX_NODES;
use nalgebra::Point2;
use parameters::{Parameters, ParamsError, between, each};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use trajectory::options::{Constraints, Guess, MAX_CONTROL_POINTS};
use trajectory::problem::MAX_NUMBER;
use trajectory::{Method, Options, ProblemError};

/// Options of the optimiser, with lengths in pixels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PlanOptions {
    /// Method of the optimiser.
    pub method: Method,
    /// Initial path of the optimisation.
    pub guess: Guess,
    /// Points of the curve at which obstacles are checked.
    pub constraints: Constraints,
    /// `true` to try other methods if the requested one finds no valid trajectory.
    pub fallbacks: bool,
    /// Degree of the B-spline; the method's own if absent.
    #[schemars(transform = between(2, MAX_DEGREE))]
    pub degree: Option<usize>,
    /// Number of its control points, more than `degree`; as many as the path needs if absent.
    #[schemars(transform = between(3, MAX_CONTROL_POINTS))]
    pub control_points: Option<usize>,
    /// Number N, for N + 1 Legendre–Gauss–Lobatto nodes; 15 if absent.
    #[schemars(transform = between(2, MAX_NODES))]
    pub nodes: Option<usize>,
    /// Reference point of `vmc`, x and y; far beyond the lower corner of the board if absent.
    #[schemars(transform = each(between(-MAX_NUMBER, MAX_NUMBER).unit("px")))]
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
    /// Converts the options for the optimiser, for pixels of this size (m).
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

    /// Checks the options that do not depend on the instance.
    ///
    /// # Errors
    /// [`ProblemError`] for the first option that is out of range.
    pub fn validate(&self) -> Result<(), ProblemError> {
        self.scaled(1.0).validate()
    }
}

impl Parameters for PlanOptions {
    fn check_relations(&self) -> Result<(), ParamsError> {
        self.validate()
            .map_err(|error| ParamsError::new(&error.field, &error.value, error.expected))
    }
}
