//! Evader that plays a reach–avoid game against optimal pursuers.
//!
//! Several times a second it looks for an escape that no pursuer can prevent ([`pursuit_evasion::escape`]).
//! It keeps the course of the first one that it finds, and plans again only if something disturbs its
//! drive. Without one it drives to the place of the highest worth ([`evader::worth`]) among those
//! that it reaches before any pursuer could (`navigation::dominance`): near the exit, but with time to
//! spare, so that pursuers that approach it leave the exit open.

pub mod evader;
pub mod params;
pub mod process;

pub use evader::Evader;
pub use params::ReachAvoidParams;
