//! What counts say, and how surely: intervals of shares, comparisons of two shares, critical values.
//!
//! Outcomes of the evaders of one game are not independent of each other: who hunts one of them lets
//! the other go. A [`Sample`] therefore remembers games, and everything that is made of it (its
//! interval, a [`Difference`], a [`Critical`] value) counts as many outcomes as there would have to
//! be independent ones ([`Sample::effective_size`]). [`wilson()`] and [`fisher_exact`] work on plain
//! counts, as one has them of published results.
//!
//! Elementary functions are the project's own ([`sim_backend::math`]), and sums are over integers or
//! in a fixed order: the same results give the same figures everywhere.

mod critical;
mod crossing;
mod difference;
mod distribution;
mod fisher;
mod holm;
mod interval;
mod logistic;
mod mean;
mod newcombe;
mod normal;
mod sample;
mod spread;
mod wilson;

pub use critical::{Critical, Estimate};
pub use crossing::Crossing;
pub use difference::{Difference, difference_of_differences};
pub use distribution::{Distribution, Distributions, LogHistogram, Percentiles};
pub use fisher::fisher_exact;
pub use holm::holm;
pub use interval::Interval;
pub use logistic::{Dose, Logistic, LogisticError};
pub use mean::Mean;
pub use newcombe::newcombe;
pub use normal::{Z95, simultaneous_z, two_sided, upper_tail, z_of_tail};
pub use sample::Sample;
pub use spread::{Spread, paired_ratio};
pub use wilson::{wilson, wilson_at};
