//! What all coverage planners share: the site that they plan for, their process, and how a robot is
//! driven from sub-goal to sub-goal.
//!
//! - [`design`]: what a kind of coverage planner must say of itself;
//! - [`follower`]: its process;
//! - [`arc_driver`]: driving past sub-goals without stopping at them;
//! - [`params`]: what can be set of all that.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod arc_driver;
pub mod design;
pub mod follower;
pub mod params;

pub use params::{FollowParams, Interpolation};
