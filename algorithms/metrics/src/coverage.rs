//! Coverage of a workplace by a path: rate and evenness.
//!
//! The workplace is divided into square cells of side `g`. A cell counts if its centre is a free
//! position of the robot's centre ([`CellGrid`]). The coverage rate is `C = covered / coverable`
//! cells, as in the literature on chaotic path planners (Volos et al.; Fallahi and Leung). There
//! are three criteria for a covered cell:
//!
//! - *goals*: a sub-goal lies in it ([`Visits`]);
//! - *path*: a point of the interpolated path lies in it ([`Visits`], which also computes the
//!   evenness);
//! - *disc*: its centre comes within the robot's radius of the path ([`SweptCells`]).
//!
//! [`Meter`] keeps all of them for the usual cell sides while a path grows, so that the coverage is
//! available for every length of it.

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
pub use swept::SweptCells;
pub use visits::Visits;

/// Maximum number of cells of a workplace.
pub const MAX_CELLS: usize = 16_000_000;

/// Tolerance of comparisons of lengths (m), and of cell numbers (cells).
pub(crate) const TOLERANCE: f64 = 1e-9;
