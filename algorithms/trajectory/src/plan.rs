//! What the optimiser answers.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use trajectory_check::Sample;

use crate::problem::ProblemError;

/// How a plan is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// The path is a cubic B-spline.
    #[default]
    Bspline,
    /// The path pursues a virtual prey that moves on a B-spline (Eq. 1–14 of the paper).
    Lp,
    /// The path hides before a virtual prey on a B-spline: it stays on the line from the prey to a
    /// reference point (Eq. 16–22 of the paper).
    Vmc,
    /// The exact shortest path: straight lines and arcs, with turns on the spot where they need be.
    Tangent,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Bspline, Self::Lp, Self::Vmc, Self::Tangent];

    /// The name that requests and commands use.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bspline => "bspline",
            Self::Lp => "lp",
            Self::Vmc => "vmc",
            Self::Tangent => "tangent",
        }
    }

    /// The method with this name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }
}

/// How a plan came about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// By the method asked for.
    Planned,
    /// By the exact shortest path: the method found nothing that passed the check.
    Fallback,
    /// As far as the time allowed went.
    Deadline,
}

/// A trajectory that has passed the trajectory check.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// How it came about.
    pub status: Status,
    /// The method that made it.
    pub method: Method,
    /// The trajectory; the first sample at the start, the last at the goal.
    pub samples: Vec<Sample>,
    /// Duration (s).
    pub final_time: f64,
    /// No trajectory can be shorter than this (s).
    pub lower_bound: f64,
    /// Length of the path (m).
    pub length: f64,
    /// Smallest distance (m) of the path to a grown obstacle; infinite without obstacles.
    pub min_clearance: f64,
    /// Convex programs solved.
    pub iterations: u32,
    /// Degrees of freedom of the curve: its control points; 0 for one without.
    pub control_points: u32,
}

impl Plan {
    /// How much longer than the lower bound it takes, relative to it; 0 if both are 0.
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

/// Why there is no plan.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PlanError {
    /// The problem cannot be meant so.
    #[error(transparent)]
    Invalid(#[from] ProblemError),
    /// No path leads to the goal.
    #[error("no path leads from the start to the goal")]
    NoPath,
    /// There are paths, but none on which the prescribed speeds can be kept.
    #[error("no trajectory keeps the limits: {0}")]
    Infeasible(&'static str),
    /// The curve asked for is not honest, and nothing else was to be tried.
    #[error("the method found no trajectory that passes the check")]
    InvalidTrajectory,
    /// It was told to stop before there was any plan.
    #[error("stopped before there was a plan")]
    Stopped,
}
