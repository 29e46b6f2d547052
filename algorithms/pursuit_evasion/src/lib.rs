//! Evaders among pursuers.
//!
//! - [`escape`]: drives to an exit that no pursuer can prevent;
//! - [`potential_evader`]: an evader that uses potential fields only.
//!
//! All functions are pure: equal inputs give equal bits on every machine.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod escape;
pub mod potential_evader;
