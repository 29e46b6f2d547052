//! Comparisons of shares and values at which they reach one half, beyond the intervals that sweeps
//! have themselves ([`statistics`]).
//!
//! Outcomes of one game depend on each other: a [`Difference`] counts as many outcomes as there would
//! have to be independent ones. [`fisher_exact`] works on plain counts, as published results have them.

mod crossing;
mod difference;
mod fisher;
mod holm;
mod newcombe;
mod normal;

pub use crossing::Crossing;
pub use difference::{Difference, difference_of_differences};
pub use fisher::fisher_exact;
pub use holm::holm;
pub use newcombe::newcombe;
pub use normal::simultaneous_z;
