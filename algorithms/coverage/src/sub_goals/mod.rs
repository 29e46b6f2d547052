//! Sub-goals in a planner: their site, and the drivers to them.
//!
//! - [`site`]: the workplace of a robot;
//! - [`arc_driver`]: driver past sub-goals without stops;
//! - [`params`]: the parameters of all coverage planners.

pub mod arc_driver;
pub mod params;
pub mod site;

pub use params::{FollowParams, Interpolation};
