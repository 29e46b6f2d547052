//! Drives a robot to goals: requests trajectories from the optimiser, tracks them, and replans when
//! the world changes.
//!
//! [`Navigator`] is the algorithm: per tick it makes the request, accepts the answer and commands
//! the robot. [`process`] connects it to its topics and to `optimiser/plan`.

pub mod drive;
pub mod excerpt;
pub mod follow;
pub mod navigator;
pub mod params;
mod plan_failure;
pub mod process;
pub mod tracking;
pub mod traffic;
pub mod trajectory;
pub mod wire;

pub use navigator::{Decision, Navigator, NavigatorError};
pub use params::NavigatorParams;
pub use plan_failure::PlanFailure;
pub use trajectory::{Trajectory, TrajectoryError};
