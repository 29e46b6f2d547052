//! Evader driven by potential fields.
//!
//! Attraction to the nearest exit + repulsion from Police, fellow evaders and obstacles, followed
//! by feedback linearisation (chasing-game paper, §III-F). The paper's exact parameters are
//! [`EvaderParams::paper`]; every deviation of the defaults is a named parameter.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod evader;
pub mod params;
pub mod process;

pub use evader::Evader;
pub use params::EvaderParams;
