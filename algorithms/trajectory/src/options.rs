//! Options of planning.

use nalgebra::Point2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::plan::Method;
use crate::problem::{MAX_NUMBER, ProblemError};
use curves::bspline_basis::MAX_DEGREE;
use curves::lgl_nodes::MAX_NODES;

/// Maximum number of control points.
pub const MAX_CONTROL_POINTS: usize = 64;

/// Work at which every plan ends with its best result so far: several times that of nearly all, about 0.1 s of a processor.
pub const MAX_WORK: u64 = 1_250_000;

/// Initial path of a method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Guess {
    /// The exact shortest path.
    #[default]
    Tangent,
    /// The wavefront on a grid (the paper's), pulled taut.
    Wavefront,
}

/// Points of the curve at which obstacles are tested.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Constraints {
    /// Everywhere, dense enough to miss none.
    #[default]
    Dense,
    /// Only at the N + 1 Legendre–Gauss–Lobatto nodes, as in the paper. Obstacles between two nodes
    /// are not detected: most such curves hit one, and are then rejected.
    Nodes,
}

/// Options of a plan; the defaults are the recommended values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Options {
    /// The method.
    pub method: Method,
    /// Initial path.
    pub guess: Guess,
    /// Points of the curve at which obstacles are tested.
    pub constraints: Constraints,
    /// `true` to try alternatives if the requested curve fails the check or is not good: turning on
    /// the spot before and after it, more control points, and finally the exact shortest path.
    pub fallbacks: bool,
    /// `true` to search in the controls where speeds cannot step; with `fallbacks` and `bspline` also
    /// where the curve is not near the lower bound.
    pub refine: bool,
    /// Degree of the B-spline, 2…8; absent: 3, or 2 for the prey of `lp`.
    pub degree: Option<usize>,
    /// Number of its control points, spread evenly, from degree + 1 to 64; absent: as many as the
    /// path needs, at the places where it needs them.
    pub control_points: Option<usize>,
    /// N of the N + 1 Legendre–Gauss–Lobatto nodes: of the path control parameter of `vmc`, and of
    /// [`Constraints::Nodes`]; 2…64.
    pub nodes: usize,
    /// Reference point of `vmc` (m); absent: 2.25 diagonals of the bounds beyond their smaller
    /// corner.
    pub reference_point: Option<Point2<f64>>,
    /// Work ([`Plan::work`](crate::Plan::work)) at which the search ends with its best result so
    /// far; at most, and if it is absent, [`MAX_WORK`].
    pub max_work: Option<u64>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            method: Method::default(),
            guess: Guess::default(),
            constraints: Constraints::default(),
            fallbacks: true,
            refine: true,
            degree: None,
            control_points: None,
            nodes: 15,
            reference_point: None,
            max_work: None,
        }
    }
}

impl Options {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ProblemError`] names the first field that is out of range.
    pub fn validate(&self) -> Result<(), ProblemError> {
        let degree = self.degree.unwrap_or(3);
        within("degree", degree, 2, MAX_DEGREE)?;
        if let Some(count) = self.control_points {
            within("control_points", count, degree + 1, MAX_CONTROL_POINTS)?;
        }
        within("nodes", self.nodes, 2, MAX_NODES)?;
        if let Some(p) = self.reference_point
            && !(p.x.abs() <= MAX_NUMBER && p.y.abs() <= MAX_NUMBER)
        {
            return Err(ProblemError {
                field: "reference_point".to_owned(),
                value: format!("({}, {})", p.x, p.y),
                expected: format!("coordinates of at most {MAX_NUMBER:e} (m) in magnitude"),
            });
        }
        Ok(())
    }
}

fn within(field: &str, value: usize, low: usize, high: usize) -> Result<(), ProblemError> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(ProblemError {
        field: field.to_owned(),
        value: value.to_string(),
        expected: format!("a whole number from {low} to {high}"),
    })
}
