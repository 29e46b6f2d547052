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
pub mod process;
pub mod tracking;
pub mod traffic;
pub mod trajectory;
pub mod trajectory_request;
pub mod wire;

pub use navigator::{Decision, Navigator, NavigatorError};
pub use params::NavigatorParams;
pub use trajectory::{Trajectory, TrajectoryError};
pub use trajectory_request::{PlanFailure, TrajectoryRequest};
