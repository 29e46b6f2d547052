//! Helpers that the tests of several crates share. A dev-dependency only.
//!
//! It uses low floors only. Unit tests of those crates cannot use it, since they would meet their own types in two
//! versions; their `tests/` can.

#![allow(clippy::expect_used, clippy::panic, clippy::missing_panics_doc)]

mod city;
mod shapes;

pub use city::{
    Arena, CITY, DT, EXIT, Kinematic, RADIUS, Rectangle, SIGMA, open_ground, robot, street_starts,
    view,
};
pub use shapes::{circle, map, rectangle};
