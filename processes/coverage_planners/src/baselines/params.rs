//! Parameters of the baselines.

use chaotic_maps::Key;
use coverage::sub_goals::params::FollowParams;
use parameters::{Parameters, ParamsError, within};

parameters::table! {
    /// Parameters of the boustrophedon.
    pub struct BoustrophedonParams {
        /// Parameters that all planners of sub-goals share.
        pub follow: FollowParams,
    }
}

impl Parameters for BoustrophedonParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        self.follow.check_relations().map_err(within("follow"))
    }
}

parameters::table! {
    /// Parameters of the random baselines.
    pub struct RandomParams {
        /// The key, `keyed:` and 64 hexadecimal digits; absent: made from the seed of the run.
        pub key: Option<Key>,
        /// Parameters that all planners of sub-goals share.
        pub follow: FollowParams,
    }
}

impl Parameters for RandomParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        crate::require_secret(self.key)?;
        self.follow.check_relations().map_err(within("follow"))
    }
}
