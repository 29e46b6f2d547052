//! Options of planning.

use parameters::{Parameters, ParamsError, between, each};

use crate::method::{Constraints, Guess, Method};
use crate::problem::{MAX_NUMBER, ProblemError};
use curves::bspline_basis::MAX_DEGREE;
use curves::lgl_nodes::MAX_NODES;

/// Maximum number of control points.
pub const MAX_CONTROL_POINTS: usize = 64;

/// Work at which every plan ends with its best result so far: several times that of nearly all, about 0.1 s of a processor.
pub const MAX_WORK: u64 = 1_250_000;

/// Number N of nodes if options state none.
const NODES: usize = 15;

parameters::table! {
    /// Options of a plan; the defaults are the recommended values.
    #[derive(Copy)]
    pub struct Options {
        /// Method of the optimiser.
        pub method: Method,
        /// Initial path of the optimisation.
        pub guess: Guess,
        /// Points of the curve at which obstacles are checked.
        pub constraints: Constraints,
        /// `true` to try other methods if the requested one finds no valid trajectory.
        // Turning on the spot before and after the curve, more control points, and finally the exact shortest path.
        pub fallbacks: bool = true,
        /// `true` to search in the controls where speeds cannot step; with `fallbacks` and `bspline` also
        /// where the curve is not near the lower bound.
        #[serde(skip)]
        pub refine: bool = true,
        /// Degree of the B-spline; the method's own if absent.
        pub degree: Option<usize> [between(2, MAX_DEGREE)],
        /// Number of its control points, more than `degree`; as many as the path needs if absent.
        pub control_points: Option<usize> [between(3, MAX_CONTROL_POINTS)],
        /// Number N, for N + 1 Legendre–Gauss–Lobatto nodes; 15 if absent.
        // Of the path control parameter of `vmc`, and of `Constraints::Nodes`.
        pub nodes: Option<usize> [between(2, MAX_NODES)],
        /// Reference point of `vmc`, x and y; far beyond the lower corner of the board if absent.
        pub reference_point: Option<[f64; 2]> [each(between(-MAX_NUMBER, MAX_NUMBER).unit("px"))],
        /// Work at which the search ends with its best result so far; at most, and if it is absent, [`MAX_WORK`].
        #[serde(skip)]
        pub max_work: Option<u64>,
    }
}

impl Options {
    /// The same options in another unit of length, of which the present one has `scale`.
    #[must_use]
    pub fn scaled(&self, scale: f64) -> Self {
        Self {
            reference_point: self.reference_point.map(|point| point.map(|x| x * scale)),
            ..*self
        }
    }

    /// N of the N + 1 Legendre–Gauss–Lobatto nodes.
    pub fn node_count(&self) -> usize {
        self.nodes.unwrap_or(NODES)
    }

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
        within("nodes", self.node_count(), 2, MAX_NODES)?;
        if let Some([x, y]) = self.reference_point
            && !(x.abs() <= MAX_NUMBER && y.abs() <= MAX_NUMBER)
        {
            return Err(ProblemError {
                field: "reference_point".to_owned(),
                value: format!("({x}, {y})"),
                expected: format!("coordinates of at most {MAX_NUMBER:e} (m) in magnitude"),
            });
        }
        Ok(())
    }
}

impl Parameters for Options {
    fn check_relations(&self) -> Result<(), ParamsError> {
        self.validate()
            .map_err(|error| ParamsError::new(&error.field, &error.value, error.expected))
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
