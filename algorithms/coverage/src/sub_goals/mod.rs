//! Sub-goals in a planner: the site that they are made for, and how a robot is driven to them.
//!
//! - [`site`]: the workplace that a robot finds itself in;
//! - [`arc_driver`]: driving past sub-goals without stopping at them;
//! - [`params`]: the parameters of all coverage planners.

pub mod arc_driver;
pub mod params;
pub mod site;

pub use params::{FollowParams, Interpolation};
