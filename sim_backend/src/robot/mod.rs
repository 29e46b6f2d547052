//! Robots: their state, and how a command becomes motion.

pub(crate) mod drive;
mod state;

pub use state::{ContactCounts, Robot, RobotStatus};
