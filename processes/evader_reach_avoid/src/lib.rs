//! Evader that plays a reach–avoid game against pursuers at their best.
//!
//! Several times a second it asks which places it reaches before any pursuer could
//! (`navigation::dominance`: dynamic programming on the grid). If an exit is among them it goes there:
//! nobody can stop it. If not, it goes to the place among them that is worth most
//! ([`evader::worth`]): near the exit, but with time to spare, so that pursuers who come for it leave
//! the exit to it.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod evader;
pub mod params;
pub mod process;

pub use evader::Evader;
pub use params::ReachAvoidParams;
