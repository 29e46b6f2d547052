//! Evader that drives straight ahead and avoids nothing.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod params;
pub mod process;
pub mod straight;

pub use params::StraightParams;
