//! Parameters of the keyed coverage planner.

use chaotic_maps::Key;
use coverage::keyed::KeyedParams;
use coverage::sub_goals::params::FollowParams;
use serde::{Deserialize, Serialize};
use sim_backend::params::{ParamsError, within};

/// Parameters of the keyed coverage planner.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct KeyedCoverageParams {
    /// The key, `keyed:` and 64 hexadecimal digits; absent: made from the seed of the run.
    pub key: Option<Key>,
    /// How sub-goals are chosen.
    pub goals: KeyedParams,
    /// Whether the planner goes by where the robot really was instead of by the legs that it was
    /// sent along: covers what was missed, but an ally with the key alone cannot foretell it.
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

impl KeyedCoverageParams {
    /// Checks every field that can be checked without the map.
    ///
    /// # Errors
    /// [`ParamsError`] with the path of the first field that is out of range.
    pub fn validate(&self) -> Result<(), ParamsError> {
        crate::require_secret(self.key)?;
        self.goals.validate().map_err(within("goals"))?;
        self.follow.validate().map_err(within("follow"))
    }
}
