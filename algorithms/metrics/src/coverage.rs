//! How much of a workplace a path has covered, and how evenly.
//!
//! The workplace is divided into square cells of side `g`. A cell counts if its centre is where the
//! robot's centre may be ([`CellGrid`]); the coverage rate is `C = covered / coverable` cells, in
//! the sense of the rate that the literature on chaotic path planners uses (Volos et al.; Fallahi
//! and Leung). Three things can cover a cell:
//!
//! - *goals*: a sub-goal lies in it ([`Visits`]);
//! - *path*: a point of the interpolated path lies in it ([`Visits`], which also has the evenness);
//! - *disc*: its centre comes within the robot's radius of the path ([`Swept`]).
//!
//! [`Meter`] keeps all of them for the usual sides of cells while a path grows, so that coverage
//! can be read after any length of it.

mod domain;
mod grid;
mod meter;
mod spans;
mod swept;
#[cfg(test)]
mod tests;
mod visits;

pub use domain::{CoverageDomain, CoverageError, Rectangle};
pub use grid::CellGrid;
pub use meter::{CELL_SIDES, DISC_CELL_SIDE, Figures, Meter, Rate};
pub use spans::{Axis, Lattice, Span};
pub use swept::Swept;
pub use visits::Visits;

/// Most cells that a workplace may be divided into.
pub const MAX_CELLS: usize = 16_000_000;

/// Tolerance of everything that compares lengths (m), and of cell numbers (cells).
pub(crate) const TOLERANCE: f64 = 1e-9;
