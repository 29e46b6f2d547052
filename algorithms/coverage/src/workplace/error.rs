//! Errors of a workplace.

use geometry::shape::{Aabb, ShapeError};
use thiserror::Error;

use super::{MAX_RECTANGLES, MIN_TOLERANCE};

/// Reason why a workplace is invalid; each text contains the remedy.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum WorkplaceError {
    /// The bounds are empty, reversed or not finite.
    #[error(
        "workplace from ({}, {}) to ({}, {}): expected finite corners (m), the first one below and \
         left of the second", .0.min.x, .0.min.y, .0.max.x, .0.max.y
    )]
    Bounds(Aabb),
    /// The robot does not fit.
    #[error(
        "radius = {radius}: expected a number ≥ 0 and below {limit} (m), half the shorter side of \
         the workplace; enlarge the workplace or take a smaller robot"
    )]
    Radius {
        /// Actual radius (m).
        radius: f64,
        /// Upper limit of radii (m).
        limit: f64,
    },
    /// The tolerance of the conversion is not a length.
    #[error("tolerance = {tolerance}: expected a finite number of at least {MIN_TOLERANCE} (m)")]
    Tolerance {
        /// Actual tolerance (m).
        tolerance: f64,
    },
    /// An obstacle is not a valid shape: a value that is not finite, edges that cross, no inside.
    #[error("obstacles[{index}]: {source}")]
    Shape {
        /// Index of the obstacle, from 0.
        index: usize,
        /// Error of the shape.
        source: ShapeError,
    },
    /// A piece of the map is not finite.
    #[error("piece {index} of the obstacles has coordinates that are not finite (m)")]
    NotFinite {
        /// Index of the piece, from 0.
        index: usize,
    },
    /// An obstacle lies outside the workplace.
    #[error(
        "obstacles[{index}] lies outside the workplace from ({}, {}) to ({}, {}): move it inside or \
         leave it out", .bounds.min.x, .bounds.min.y, .bounds.max.x, .bounds.max.y
    )]
    Outside {
        /// Index of the obstacle, from 0.
        index: usize,
        /// The workplace (m).
        bounds: Aabb,
    },
    /// An obstacle covers the whole workplace.
    #[error(
        "obstacles[{index}] covers the whole workplace: make the obstacle or the robot's radius \
         smaller, or the workplace larger"
    )]
    Covering {
        /// Index of the obstacle, from 0.
        index: usize,
    },
    /// The obstacles become too many rectangles.
    #[error(
        "tolerance = {tolerance}: the obstacles become more than {MAX_RECTANGLES} rectangles; take \
         a larger tolerance"
    )]
    TooManyRectangles {
        /// Actual tolerance (m).
        tolerance: f64,
    },
}
