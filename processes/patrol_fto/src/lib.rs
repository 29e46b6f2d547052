//! Patrols past fictive temporary obstacles, alone or mixed with additional waypoints (cat-map patrol
//! paper, §5.2 and §6).
//!
//! [`PatrolFto`] is the planner: fictive obstacles ([`patrol::fto`]) are put into the robot's range
//! scan, and the waypoint driver of [`guidance`] avoids them as it avoids real ones. [`process`]
//! wires it to its topics.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod params;
mod planner;
pub mod process;

pub use params::{PatrolFtoParams, Protection};
pub use planner::{PatrolFto, PatrolFtoError};
