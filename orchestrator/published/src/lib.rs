//! Computations for published results that need no mission. The claims and pages that follow from them are those of
//! the Python package, `protean_robotics.lab`.
//!
//! - [`plans`]: single plans of the RRT* evaders of the chasing game;
//! - [`laps`]: laps of the zig-zag of the cat-map patrol paper;
//! - [`sequences`]: sequences of the Chebyshev coverage paper.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

use core::error::Error;
use std::sync::Arc;

pub mod laps;
pub mod plans;
pub mod sequences;

/// A scenario does not serve the computation.
#[derive(Debug, Clone, thiserror::Error)]
#[error("{scenario}: {source}")]
pub struct ScenarioError {
    /// The scenario.
    pub scenario: String,
    /// Reason.
    pub source: Arc<dyn Error + Send + Sync>,
}

impl ScenarioError {
    fn new(scenario: &str, reason: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self {
            scenario: scenario.to_owned(),
            source: reason.into().into(),
        }
    }
}
