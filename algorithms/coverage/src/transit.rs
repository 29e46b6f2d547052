//! Transits of a plan from one rectangle to the next.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Method of transit between two rectangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Transit {
    /// One sub-goal in the part of the bridge on this side, one in the part on the other.
    #[default]
    Direct,
    /// As printed in the Chebyshev coverage paper, §5.2, steps 5 and 6: sub-goals in the current
    /// rectangle until one lies in the bridge, then sub-goals in the bridge until one lies in the
    /// next rectangle. That can take millions of sub-goals, so there is a cap.
    Wait {
        /// Maximum number of sub-goals on either side before the transit is ended directly.
        #[schemars(transform = parameters::at_least(1))]
        cap: u32,
    },
}

/// Numbers of sub-goals of transits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Dwell {
    /// Number of transits made or begun.
    pub transits: u64,
    /// Number of sub-goals in the rectangle that was left.
    pub leaving: u64,
    /// Number of sub-goals in the bridge.
    pub crossing: u64,
    /// Maximum number of sub-goals of one transit.
    pub longest: u32,
    /// Number of transits that reached the cap.
    pub capped: u64,
}

impl Dwell {
    /// Number of sub-goals of all transits.
    pub fn goals(&self) -> u64 {
        self.leaving + self.crossing
    }
}
