//! Evader driven by potential fields: [`pursuit_evasion::potential_evader`] in its process.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod process;

pub use pursuit_evasion::potential_evader::{Evader, EvaderParams};
