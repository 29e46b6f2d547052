//! Robots: their state, conditions on it, and imperfections of their drives.

mod condition;
pub(crate) mod imperfection;
mod state;

pub use state::{ContactCounts, Robot, RobotStatus};
