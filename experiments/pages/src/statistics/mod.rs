//! Comparisons of shares, and values at which they cross one half, beyond the intervals of sweeps
//! ([`statistics`]).
//!
//! Outcomes of one game depend on each other: a [`Difference`] uses the equivalent number of
//! independent outcomes. [`fisher_exact`] works on plain counts, as in published results.

mod crossing;
mod difference;
mod fisher;
mod holm;
mod newcombe;
mod normal;

pub use crossing::Crossings;
pub use difference::{Difference, difference_of_differences};
pub use fisher::fisher_exact;
pub use holm::holm;
pub use newcombe::newcombe;
pub use normal::simultaneous_z;
