//! An evader driven by potential fields.
//!
//! Attraction to the nearest exit + repulsion from Police, teammates and obstacles, followed
//! by feedback linearisation (chasing-game paper, §III-F). The paper's exact parameters are
//! [`EvaderParams::paper`]; every deviation of the defaults is a named parameter. Evaders that plan
//! fall back to it.

mod evader;
mod params;

pub use evader::Evader;
pub use params::{EvaderParams, ThreatParams};
