//! A robot with a range sensor and a waypoint driver among unknown obstacles.

mod driver;
mod in_sight;
mod random;
mod worlds;
