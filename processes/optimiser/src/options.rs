//! How a plan shall be made.

use nalgebra::Point2;
use serde::{Deserialize, Serialize};

use crate::plan::Method;

/// From what path a method starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Guess {
    /// The exact shortest path.
    #[default]
    Tangent,
    /// The wavefront on a grid (the paper's), pulled taut.
    Wavefront,
}

/// Options of a plan; the defaults are what is recommended.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Options {
    /// The method.
    pub method: Method,
    /// From what path it starts.
    pub guess: Guess,
    /// Degree of the B-spline, 2…8; absent: 3, or 2 for the prey of `lp`.
    pub degree: Option<usize>,
    /// Number of its control points, spread evenly, from degree + 1 to 64; absent: as many as the
    /// path needs, where it needs them.
    pub control_points: Option<usize>,
    /// N of the N + 1 Legendre–Gauss–Lobatto nodes of the path control parameter of `vmc`, 2…64.
    pub nodes: usize,
    /// Reference point of `vmc` [m]; absent: 2.25 diagonals of the bounds beyond their smaller
    /// corner.
    pub reference_point: Option<Point2<f64>>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            method: Method::default(),
            guess: Guess::default(),
            degree: None,
            control_points: None,
            nodes: 15,
            reference_point: None,
        }
    }
}
