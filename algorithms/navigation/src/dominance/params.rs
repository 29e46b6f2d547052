//! Parameters of the dominance regions.

use parameters::{Parameters, above};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Resolution of dominance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DominanceParams {
    /// Side of a cell, rounded to whole cells of the map. Cost grows with its inverse
    /// square.
    #[schemars(transform = above(0).unit("m"))]
    pub pitch: f64,
}

impl Default for DominanceParams {
    fn default() -> Self {
        Self { pitch: 0.2 }
    }
}

impl Parameters for DominanceParams {}
