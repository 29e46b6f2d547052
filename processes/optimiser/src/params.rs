//! Parameters of the process.

use parameters::{Parameters, between};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Maximum number of threads that plan.
const MAX_WORKERS: u32 = 16;

/// Parameters of the process `optimiser`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct OptimiserParams {
    /// Threads that plan: the number of parallel requests. (A run in one process answers requests
    /// one after the other.)
    #[schemars(transform = between(1, MAX_WORKERS))]
    pub workers: u32,
}

impl Default for OptimiserParams {
    fn default() -> Self {
        Self { workers: 2 }
    }
}

impl Parameters for OptimiserParams {}
