//! Parameters of the baselines.

use chaotic_maps::Key;
use coverage::sub_goals::params::FollowParams;
use serde::{Deserialize, Serialize};
use sim_backend::params::{ParamsError, within};

/// Parameters of the boustrophedon.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BoustrophedonParams {
    /// What all planners of sub-goals share.
    pub follow: FollowParams,
}

impl BoustrophedonParams {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] with the path of the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        self.follow.validate().map_err(within("follow"))
    }
}

/// Parameters of the random baselines.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RandomParams {
    /// The key, `keyed:` and 64 hexadecimal digits; absent: made from the seed of the run.
    pub key: Option<Key>,
    /// What all planners of sub-goals share.
    pub follow: FollowParams,
}

impl RandomParams {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamsError`] with the path of the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        crate::require_secret(self.key)?;
        self.follow.validate().map_err(within("follow"))
    }
}
