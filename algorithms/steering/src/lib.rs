//! Steering of differential-drive robots.
//!
//! Attraction and repulsion by potentials:
//!
//! 1. [`potential_field`] sums attraction, repulsion, obstacles and perturbation;
//! 2. [`feedback_linearisation`] converts the desired velocity of a point ahead of the axle into
//!    forward speed and turning rate, within the robot's limits;
//! 3. [`potential_evader`] is an evader that uses only these.
//!
//! From waypoint to waypoint:
//!
//! - [`go_to`]: straight to a point;
//! - [`path_tracking`]: along a path; [`go_along`]: the same without memory;
//! - [`tangent_bug`]: around unknown obstacles, by range scans;
//! - [`waypoint_driver`]: from waypoint to waypoint, with a stop guarantee, using these.
//!
//! Away from pursuers: [`escape`] finds drives to an exit that no pursuer can prevent.
//!
//! All functions are pure: equal inputs give equal bits on every machine.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod escape;
pub mod feedback_linearisation;
pub mod go_along;
pub mod go_to;
pub mod path_tracking;
pub mod potential_evader;
pub mod potential_field;
pub mod tangent_bug;
pub mod waypoint_driver;
