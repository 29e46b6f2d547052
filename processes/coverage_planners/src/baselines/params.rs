//! Parameters of the baselines.

use chaotic_maps::Key;
use coverage::sub_goals::params::FollowParams;
use parameters::{Parameters, ParamsError, within};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Parameters of the boustrophedon.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BoustrophedonParams {
    /// Parameters that all planners of sub-goals share.
    pub follow: FollowParams,
}

impl Parameters for BoustrophedonParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        self.follow.check_relations().map_err(within("follow"))
    }
}

/// Parameters of the random baselines.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RandomParams {
    /// The key, `keyed:` and 64 hexadecimal digits; absent: made from the seed of the run.
    pub key: Option<Key>,
    /// Parameters that all planners of sub-goals share.
    pub follow: FollowParams,
}

impl Parameters for RandomParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        crate::require_secret(self.key)?;
        self.follow.check_relations().map_err(within("follow"))
    }
}
