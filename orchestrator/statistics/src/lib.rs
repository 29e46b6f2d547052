//! Confidence intervals of shares and means.
//!
//! Outcomes of the evaders of one game are not independent: a pursuer that chases one evader lets another one
//! escape. A [`Sample`] therefore keeps outcomes by game, and its interval uses the number of independent
//! outcomes that carry the same information ([`Sample::effective_size`]). [`wilson()`] works on plain counts.
//!
//! Elementary functions come from [`geometry::math`], and sums are over integers or in a fixed order, so that
//! the same results give the same figures on every machine.

mod distribution;
mod interval;
mod mean;
mod sample;
mod wilson;

pub use distribution::{Distribution, Distributions, LogHistogram, Percentiles};
pub use interval::Interval;
pub use mean::Mean;
pub use metrics::quantile::quantile;
pub use sample::Sample;
pub use wilson::{Z95, wilson};
