//! Intervals of shares and means.
//!
//! Outcomes of the evaders of one game are not independent of each other: who hunts one of them lets
//! the other go. A [`Sample`] therefore remembers games, and its interval counts as many outcomes as
//! there would have to be independent ones ([`Sample::effective_size`]). [`wilson()`] works on plain
//! counts.
//!
//! Elementary functions are the project's own ([`geometry::math`]), and sums are over integers or
//! in a fixed order: the same results give the same figures everywhere.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod distribution;
mod interval;
mod mean;
mod quantile;
mod sample;
mod spread;
mod wilson;

pub use distribution::{Distribution, Distributions, LogHistogram, Percentiles};
pub use interval::Interval;
pub use mean::Mean;
pub use quantile::quantile;
pub use sample::Sample;
pub use spread::{Spread, paired_ratio};
pub use wilson::{Z95, wilson, wilson_at};
