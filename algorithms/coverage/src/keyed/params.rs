//! Parameters of keyed coverage.

use parameters::{Parameters, above, between};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Maximum number of candidates per choice.
const MAX_CANDIDATES: usize = 4096;

/// Parameters of the choice of sub-goals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct KeyedParams {
    /// Side of the cells of the coverage map; at most the radius of the disc that the robot covers.
    #[schemars(transform = above(0).unit("m"))]
    pub cell: f64,
    /// Number of orders drawn per sub-goal, of which the best is followed; 1.4 draws one or two,
    /// depending on the key. The trade-off: more cover faster and are easier to predict.
    #[schemars(transform = between(1, 4))]
    pub choices: f64,
    /// Number of candidate points per order.
    #[schemars(transform = between(1, MAX_CANDIDATES))]
    pub candidates: usize,
    /// Share of the reachable cells at which a round ends and all cells count as fresh again.
    #[schemars(transform = above(0).at_most(1))]
    pub round_at: f64,
}

impl Default for KeyedParams {
    fn default() -> Self {
        Self {
            cell: 0.1,
            choices: 1.4,
            candidates: 128,
            round_at: 0.99,
        }
    }
}

impl Parameters for KeyedParams {}
