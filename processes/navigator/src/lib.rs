//! Drives a robot to goals: asks the optimiser for trajectories, tracks them, and replans when the
//! world changes.
//!
//! [`Navigator`] is the algorithm: it says what to ask, takes what was answered, and commands the
//! robot, tick by tick. [`process`] wires it to its topics and to `optimiser/plan`.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod drive;
pub mod follow;
pub mod navigator;
pub mod params;
pub mod process;
pub mod tracking;
pub mod traffic;
pub mod trajectory;
pub mod trajectory_request;
pub mod wire;

pub use navigator::{Decision, Navigator};
pub use params::NavigatorParams;
pub use trajectory::{Trajectory, TrajectoryError};
pub use trajectory_request::{PlanFailure, TrajectoryRequest};
