//! Robots: their state, and the conversion of commands to motion.

mod condition;
pub(crate) mod drive;
mod state;

pub use drive::{integrate, limit};
pub use state::{ContactCounts, Robot, RobotStatus};
