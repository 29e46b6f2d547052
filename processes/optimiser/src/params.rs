//! Parameters of the process.

use parameters::{Parameters, between};

/// Maximum number of threads that plan.
const MAX_WORKERS: u32 = 16;

parameters::table! {
    /// Parameters of the process `optimiser`.
    #[derive(Copy, Eq)]
    pub struct OptimiserParams {
        /// Threads that plan: the number of parallel requests. (A run in one process answers requests
        /// one after the other.)
        pub workers: u32 [between(1, MAX_WORKERS)] = 2,
    }
}

impl Parameters for OptimiserParams {}
