//! What a coverage planner says of itself.

use core::fmt::Debug;
use parameters::Parameters;

use coverage::goal::GoalSource;
use coverage::sub_goals::params::FollowParams;
use coverage::sub_goals::site::Site;

/// A kind of coverage planner: how to make its sub-goals. The process does the rest.
pub trait Design: 'static {
    /// The name of its kind, which scenarios use (`kind = "…"`).
    const NAME: &'static str;
    /// What it does, in one line.
    const SUMMARY: &'static str;

    /// Its parameters. All of them have defaults.
    type Params: Parameters + Default + Clone + PartialEq + Debug + Send + Sync;
    /// Its sub-goals.
    type Goals: GoalSource;

    /// The parameters that all kinds share.
    fn follow(params: &Self::Params) -> FollowParams;

    /// The sub-goals for a site; `seed` is the robot's own. `before` are those for the site that it
    /// replaces, if the map has changed: secrets and numbers go on from there.
    ///
    /// # Errors
    /// A text that says what does not fit the site.
    fn goals(
        params: &Self::Params,
        site: &Site,
        seed: u64,
        before: Option<Self::Goals>,
    ) -> Result<Self::Goals, String>;
}
