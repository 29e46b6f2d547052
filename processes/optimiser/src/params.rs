//! Parameters of the process.

use serde::{Deserialize, Serialize};
use sim_backend::params::{ParamsError, require};

/// Most threads that plan.
const MAX_WORKERS: u32 = 16;

/// Parameters of the process `optimiser`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OptimiserParams {
    /// Threads that plan: requests that are worked on at the same time, 1…16. (A run in one process
    /// answers one after the other.)
    pub workers: u32,
}

impl Default for OptimiserParams {
    fn default() -> Self {
        Self { workers: 2 }
    }
}

impl OptimiserParams {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        require(
            (1..=MAX_WORKERS).contains(&self.workers),
            "workers",
            &self.workers,
            "a number from 1 to 16",
        )
    }
}
