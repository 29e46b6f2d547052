//! Parameters of the keyed coverage planner.

use chaotic_maps::Key;
use coverage::keyed::KeyedParams;
use coverage::sub_goals::params::FollowParams;
use parameters::{Parameters, ParamsError, within};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Parameters of the keyed coverage planner.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct KeyedCoverageParams {
    /// The key, `keyed:` and 64 hexadecimal digits; absent: made from the seed of the run.
    pub key: Option<Key>,
    /// How sub-goals are chosen.
    pub goals: KeyedParams,
    /// Whether the planner goes by where the robot really was instead of by the legs that it was
    /// sent along: covers what was missed, but an ally with the key alone cannot predict it.
    pub track: bool,
    /// What all planners of sub-goals share.
    pub follow: FollowParams,
}

impl Default for KeyedCoverageParams {
    fn default() -> Self {
        Self {
            key: None,
            goals: KeyedParams::default(),
            track: true,
            follow: FollowParams::default(),
        }
    }
}

impl Parameters for KeyedCoverageParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        crate::require_secret(self.key)?;
        self.follow.check_relations().map_err(within("follow"))
    }
}
