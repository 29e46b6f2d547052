//! The simulated world: robots that move, collide, sense and follow rules on a map, behind one pure
//! [`World::step`](world::World::step).
//!
//! - [`spec`]: the specification of a world, as tables of a scenario (robots: the crate `robot`);
//! - [`world`]: the step, its contacts, scans, odometry, rules, coverage and events;
//! - [`robot`]: a robot's state, imperfections of its drive, and conditions on it;
//! - [`random`]: random numbers that are addressed by seed, purpose and tick.
//!
//! No IPC, no clock, no files: all functions are pure. Shapes and maps are in `geometry`.

pub mod random;
pub mod robot;
pub mod spec;
pub mod world;
