//! Sub-goals in a planner: the site that they are made for, and how a robot is driven to them.
//!
//! - [`design`]: what a kind of coverage planner must say of itself;
//! - [`arc_driver`]: driving past sub-goals without stopping at them;
//! - [`params`]: the parameters of all coverage planners.

pub mod arc_driver;
pub mod design;
pub mod params;

pub use params::{FollowParams, Interpolation};
