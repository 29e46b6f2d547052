//! Trait of coverage planners.

use core::fmt::Debug;
use parameters::Parameters;

use crate::error::DesignError;
use coverage::goal::GoalSource;
use coverage::sub_goals::params::FollowParams;
use coverage::sub_goals::site::Site;

/// Kind of coverage planner: the construction of its sub-goals. The process is common to all.
pub trait Design: 'static {
    /// Name of its kind, which scenarios use (`kind = "…"`).
    const NAME: &'static str;
    /// One-line description.
    const SUMMARY: &'static str;

    /// Parameters. All of them have defaults.
    type Params: Parameters + Default + Clone + PartialEq + Debug + Send + Sync;
    /// Its sub-goals.
    type Goals: GoalSource;

    /// Parameters that all kinds share.
    fn follow(params: &Self::Params) -> FollowParams;

    /// Returns the sub-goals for a site; `seed` is the robot's own. `before` are those for the site
    /// that it replaces, if the map has changed: secrets and numbers continue from them.
    ///
    /// # Errors
    /// [`DesignError`] names the fault of the site.
    fn goals(
        params: &Self::Params,
        site: &Site,
        seed: u64,
        before: Option<Self::Goals>,
    ) -> Result<Self::Goals, DesignError>;
}
