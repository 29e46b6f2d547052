//! The simulated world: robots that move, meet, sense and play by rules on a map, behind one pure
//! [`World::step`](world::World::step).
//!
//! - [`spec`]: what a world is made of, as tables of a scenario;
//! - [`world`]: the step, its contacts, scans, odometry, rules, coverage and events;
//! - [`robot`]: a robot's state and drive, and conditions on it;
//! - [`team`], [`random`]: sides, and random numbers that are addressed by seed, purpose and tick.
//!
//! No IPC, no clock, no files: everything is a function of its inputs. Shapes and maps are in `geometry`.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod random;
pub mod robot;
pub mod spec;
pub mod team;
pub mod world;
