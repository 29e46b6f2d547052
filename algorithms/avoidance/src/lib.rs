//! Steering around obstacles and other robots.
//!
//! - [`potential_field`]: attraction, repulsion, obstacles and perturbation, added up;
//! - [`tangent_bug`]: around unknown obstacles, by range scans;
//! - [`waypoint_driver`]: from waypoint to waypoint, with a stop guarantee.
//!
//! All functions are pure: equal inputs give equal bits on every machine.

pub mod potential_field;
pub mod tangent_bug;
pub mod waypoint_driver;
