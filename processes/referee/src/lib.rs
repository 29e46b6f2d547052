//! Referee: judges every moment of a chase by its guaranteed outcome.
//!
//! Its inputs are the true state of the world, not a team's beliefs, and the top speeds of all
//! robots. From geodesic waves (`navigation::dominance`) it computes, for every evader, whether its
//! escape is certain, and for every place, the robot that reaches it first. It steers no robot.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod params;
pub mod process;
pub mod referee;

pub use params::RefereeParams;
pub use referee::{Judgement, Referee};
