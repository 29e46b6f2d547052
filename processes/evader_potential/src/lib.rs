//! Evader driven by potential fields: [`steering::potential_evader`] in its process.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod process;

pub use steering::potential_evader::{Evader, EvaderParams};
