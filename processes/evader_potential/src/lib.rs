//! Evader driven by potential fields: [`pursuit_evasion::potential_evader`] in its process.

pub mod process;

pub use pursuit_evasion::potential_evader::{Evader, EvaderParams};
