//! How well somebody predicted where a robot would be, or which goal it would take next.
//!
//! - [`statistics`]: mean, median, root mean square and quantiles of errors, by horizon;
//! - [`next_goal`]: the next goal by the most similar past one, which no map with a short formula
//!   withstands;
//! - [`chance`]: what the errors would be if the goals were independent and uniform.

pub mod chance;
pub mod next_goal;
pub mod statistics;

pub use chance::{chance_median, chance_median_along};
pub use next_goal::{NearestNeighbour, NextGoal, View, next_goal_errors};
pub use statistics::{ErrorStatistics, ErrorsByHorizon};
