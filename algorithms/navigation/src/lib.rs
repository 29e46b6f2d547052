//! Way finding on the maps of planners.
//!
//! - [`tangent_graph`]: exact shortest paths of a disc among convex pieces;
//! - [`routes`]: ways along the streets of a grid, for all places at once;
//! - [`bearing`]: in which direction something lies, straight or along the streets;
//! - [`wavefront`]: first arrival times;
//! - [`dominance`]: who reaches what first.
//!
//! Everything here is pure: values in, values out, the same bits on every machine.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod bearing;
pub mod dominance;
pub mod routes;
pub mod tangent_graph;
pub mod wavefront;
