//! Why there is no workplace.

use geometry::shape::{Aabb, ShapeError};
use thiserror::Error;

use super::{MAX_RECTANGLES, MIN_TOLERANCE};

/// Why a workplace cannot be used; each text says what to change.
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
        /// Radius found (m).
        radius: f64,
        /// Radii must be below this (m).
        limit: f64,
    },
    /// The tolerance of the conversion is not a length.
    #[error("tolerance = {tolerance}: expected a finite number of at least {MIN_TOLERANCE} (m)")]
    Tolerance {
        /// Tolerance found (m).
        tolerance: f64,
    },
    /// An obstacle is no shape: a value that is not finite, edges that cross, no inside.
    #[error("obstacles[{index}]: {source}")]
    Shape {
        /// Which obstacle, from 0.
        index: usize,
        /// What is wrong with it.
        source: ShapeError,
    },
    /// A piece of the map is not finite.
    #[error("piece {index} of the obstacles has coordinates that are not finite (m)")]
    NotFinite {
        /// Which piece, from 0.
        index: usize,
    },
    /// An obstacle has nothing to do with the workplace.
    #[error(
        "obstacles[{index}] lies outside the workplace from ({}, {}) to ({}, {}): move it inside or \
         leave it out", .bounds.min.x, .bounds.min.y, .bounds.max.x, .bounds.max.y
    )]
    Outside {
        /// Which obstacle, from 0.
        index: usize,
        /// The workplace (m).
        bounds: Aabb,
    },
    /// An obstacle leaves nothing of the workplace.
    #[error(
        "obstacles[{index}] covers all of the workplace: make the obstacle or the robot's radius \
         smaller, or the workplace larger"
    )]
    Covering {
        /// Which obstacle, from 0.
        index: usize,
    },
    /// The obstacles become too many rectangles.
    #[error(
        "tolerance = {tolerance}: the obstacles become more than {MAX_RECTANGLES} rectangles; take \
         a larger tolerance"
    )]
    TooManyRectangles {
        /// Tolerance found (m).
        tolerance: f64,
    },
}
