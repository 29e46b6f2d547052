//! Evader driven by potential fields: [`steering::potential_evader`] in its process.

pub mod process;

pub use steering::potential_evader::{Evader, EvaderParams};
