//! Steering around obstacles and other robots.
//!
//! - [`potential_field`]: attraction, repulsion, obstacles and perturbation, added up;
//! - [`tangent_bug`]: around unknown obstacles, by range scans;
//! - [`waypoint_driver`]: from waypoint to waypoint, with a stop guarantee.
//!
//! All functions are pure: equal inputs give equal bits on every machine.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod potential_field;
pub mod tangent_bug;
pub mod waypoint_driver;
