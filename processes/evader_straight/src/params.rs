//! Parameters of the evader.

use parameters::{Parameters, between};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Parameters of the evader that drives straight ahead.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct StraightParams {
    /// Speed as a fraction of the highest forward speed.
    #[schemars(transform = between(0, 1))]
    pub speed_fraction: f64,
}

impl Default for StraightParams {
    fn default() -> Self {
        Self {
            speed_fraction: 1.0,
        }
    }
}

impl Parameters for StraightParams {}
