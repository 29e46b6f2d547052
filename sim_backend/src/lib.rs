//! The simulated world: robots that move, collide, sense and follow rules on a map, behind one pure
//! [`World::step`](world::World::step).
//!
//! - [`spec`]: the specification of a world, as tables of a scenario;
//! - [`world`]: the step, its contacts, scans, odometry, rules, coverage and events;
//! - [`robot`]: a robot's state and drive, and conditions on it;
//! - [`team`], [`random`]: teams, and random numbers that are addressed by seed, purpose and tick.
//!
//! No IPC, no clock, no files: all functions are pure. Shapes and maps are in `geometry`.

pub mod random;
pub mod robot;
pub mod spec;
pub mod team;
pub mod world;
