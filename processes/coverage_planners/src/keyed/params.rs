//! Parameters of the keyed coverage planner.

use chaotic_maps::Key;
use coverage::keyed::KeyedParams;
use coverage::sub_goals::params::FollowParams;
use parameters::{Parameters, ParamsError, within};

parameters::table! {
    /// Parameters of the keyed coverage planner.
    pub struct KeyedCoverageParams {
        /// The key, `keyed:` and 64 hexadecimal digits; absent: made from the seed of the run.
        pub key: Option<Key>,
        /// Choice of sub-goals.
        pub goals: KeyedParams,
        /// `true` to plan by the robot's real path instead of by the legs that it was sent along. It
        /// then covers what was missed, but an ally cannot predict it with the key alone.
        pub track: bool = true,
        /// Parameters that all planners of sub-goals share.
        pub follow: FollowParams,
    }
}

impl Parameters for KeyedCoverageParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        crate::require_secret(self.key)?;
        self.follow.check_relations().map_err(within("follow"))
    }
}
