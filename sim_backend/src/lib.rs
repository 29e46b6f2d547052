//! The world: maps, geometry, robots, sensors and rules behind one pure [`World::step`](world::World::step).
//!
//! No IPC, no clock, no files beyond the map loaders; everything is a function of its inputs.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod blur;
mod extent;
pub mod grid;
pub mod map;
pub mod math;
pub mod pose;
pub mod random;
mod region;
pub mod robot;
pub mod shape;
pub mod spec;
pub mod team;
pub mod visibility;
pub mod world;
