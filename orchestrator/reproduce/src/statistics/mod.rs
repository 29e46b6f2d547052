//! Comparisons of shares, and values at which they cross one half, beyond the intervals of sweeps
//! ([`statistics`]).
//!
//! Cells played on the same seeds are compared seed by seed ([`Difference`]: McNemar's exact test).
//! [`fisher_exact`] compares independent samples: ours with a published count.

mod crossing;
mod difference;
mod fisher;
mod holm;
mod mcnemar;
mod newcombe;
mod normal;
mod prediction;

pub use crossing::Crossings;
pub use difference::{BySeed, Difference, difference_of_differences};
pub use fisher::fisher_exact;
pub use holm::holm;
pub use normal::simultaneous_z;
pub use prediction::prediction_95;
