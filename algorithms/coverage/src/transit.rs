//! How a plan gets from one rectangle to the next.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What happens between two rectangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Transit {
    /// One sub-goal in the part of the bridge on this side, one in the part on the other.
    #[default]
    Direct,
    /// As printed in the Chebyshev coverage paper, §5.2, steps 5 and 6: sub-goals in the present
    /// rectangle until one lies in the bridge, then sub-goals in the bridge until one lies in the
    /// next rectangle. That can take millions of them, so that there is a cap.
    Wait {
        /// Most sub-goals on either side before the transit is ended directly.
        #[schemars(transform = parameters::at_least(1))]
        cap: u32,
    },
}

/// How many sub-goals transits took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Dwell {
    /// Transits made or begun.
    pub transits: u64,
    /// Sub-goals in the rectangle that was left.
    pub leaving: u64,
    /// Sub-goals in the bridge.
    pub crossing: u64,
    /// Most sub-goals of one transit.
    pub longest: u32,
    /// Transits that reached the cap.
    pub capped: u64,
}

impl Dwell {
    /// Sub-goals of all transits.
    pub fn goals(&self) -> u64 {
        self.leaving + self.crossing
    }
}
