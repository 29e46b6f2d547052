//! Evader that plays a reach–avoid game against optimal pursuers.
//!
//! Several times a second it computes the places that it reaches before any pursuer could
//! (`navigation::dominance`: dynamic programming on the grid). If an exit is among them it drives
//! there: no pursuer can stop it. If not, it drives to the place of the highest worth
//! ([`evader::worth`]): near the exit, but with time to spare, so that pursuers that approach it
//! leave the exit open.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod evader;
pub mod params;
pub mod process;

pub use evader::Evader;
pub use params::ReachAvoidParams;
