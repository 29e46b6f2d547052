//! Patrols along a zig-zag of additional waypoints (cat-map patrol paper): lap after lap, no two
//! alike, around obstacles, within the time ordered.
//!
//! [`PatrolAwg`] is the planner: [`patrol`] makes the waypoints, the waypoint driver of [`guidance`]
//! drives them. [`process`] wires it to its topics.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod params;
mod planner;
pub mod process;

pub use params::{Pace, PatrolAwgParams};
pub use planner::{PatrolAwg, PatrolError, SHOWN};
