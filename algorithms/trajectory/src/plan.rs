//! Results of the optimiser.

use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use trajectory_check::Sample;

use trajectory_problem::{Method, ProblemError};

/// Origin of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Found by the requested method.
    Planned,
    /// A curve of the requested method or a motion in free space: no search in the controls that began near
    /// it succeeded.
    Curve,
    /// The exact shortest path: the method found no trajectory that passed the check.
    Fallback,
    /// The best trajectory within the allowed time.
    Deadline,
}

/// Evidence of a plan's quality.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Basis {
    /// A local optimum in the controls.
    Optimal {
        /// Largest error of the first-order conditions, with the duration as the unit of time.
        residual: f64,
    },
    /// Proven: it takes no longer than the lower bound.
    Exact,
    /// None: a curve, or a motion in free space.
    Curve,
}

impl Basis {
    /// The name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Optimal { .. } => "optimal",
            Self::Exact => "exact",
            Self::Curve => "curve",
        }
    }

    /// The residual of a local optimum.
    pub fn residual(self) -> Option<f64> {
        match self {
            Self::Optimal { residual } => Some(residual),
            Self::Exact | Self::Curve => None,
        }
    }
}

/// A trajectory that has passed the trajectory check.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Origin.
    pub status: Status,
    /// The method that found it.
    pub method: Method,
    /// The trajectory; the first sample at the start, the last at the goal.
    pub samples: Vec<Sample>,
    /// Duration (s).
    pub final_time: f64,
    /// Lower bound (s) on the duration of all trajectories.
    pub lower_bound: f64,
    /// Length of the path (m).
    pub length: f64,
    /// Smallest distance (m) of the path to a grown obstacle; infinite without obstacles.
    pub min_clearance: f64,
    /// Number of convex programs of curves and of steps of searches in the controls.
    pub iterations: u32,
    /// Work of the search: the number of coefficients of its convex programs, once per step of
    /// their solver, and of inequalities and variables of a search in the controls, once per step. In
    /// proportion to it grows the computing time.
    pub work: u64,
    /// Number of control points of the curve; 0 for a curve without.
    pub control_points: u32,
    /// Evidence of its quality.
    pub basis: Basis,
    /// Number of searches in the controls that failed.
    pub failed_searches: u32,
}

impl Plan {
    /// Excess of the duration over the lower bound, relative to the bound; 0 if both are 0.
    pub fn gap(&self) -> f64 {
        if self.lower_bound > 0.0 {
            self.final_time / self.lower_bound - 1.0
        } else if self.final_time > 0.0 {
            f64::INFINITY
        } else {
            0.0
        }
    }
}

/// Reason why there is no plan.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PlanError {
    /// The problem is invalid.
    #[error(transparent)]
    Invalid(#[from] ProblemError),
    /// No path leads to the goal.
    #[error("no path leads from the start to the goal")]
    NoPath,
    /// There are paths, but none on which the prescribed speeds can be kept.
    #[error("no trajectory keeps the limits: {0}")]
    Infeasible(&'static str),
    /// The requested curve fails the check, and alternatives were not allowed.
    #[error("the method found no trajectory that passes the check")]
    InvalidTrajectory,
    /// The search was stopped before there was any plan.
    #[error("stopped before there was a plan")]
    Stopped,
}
