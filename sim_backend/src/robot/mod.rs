//! Robots: their state, and how a command becomes motion.

mod condition;
pub(crate) mod drive;
mod state;

pub use drive::limit;
pub use state::{ContactCounts, Robot, RobotStatus};
