//! Accuracy of predictions of a robot's position, or of its next goal.
//!
//! - [`statistics`]: mean, median, root mean square and quantiles of errors, by horizon;
//! - [`next_goal`]: prediction of the next goal by the most similar past one, which works for every
//!   map with a short formula;
//! - [`chance`]: errors of a guess, for independent and uniform goals.

pub mod chance;
pub mod next_goal;
pub mod statistics;

pub use chance::{chance_median, chance_median_along};
pub use next_goal::{NearestNeighbour, NextGoal, View, next_goal_errors};
pub use statistics::{ErrorStatistics, ErrorsByHorizon};
