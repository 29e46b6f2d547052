//! A referee: judges every moment of a chase by what is certain in it.
//!
//! It knows the world as it is, not as a team believes it, and the top speeds of all robots. From
//! geodesic waves (`navigation::dominance`) it says, for every evader, whether it can be sure of an
//! escape, and for every place, who reaches it first. It steers nobody.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod params;
pub mod process;
pub mod referee;

pub use params::RefereeParams;
pub use referee::{Judgement, Referee};
