//! Covers a workplace fast, by sub-goals that an observer without the key cannot predict, even with
//! knowledge of the method ([`coverage::keyed`]).

pub mod params;

use crate::design::Design;
use crate::error::DesignError;
use crate::follower::Follower;
use chaotic_maps::Key;
use coverage::keyed::KeyedCoverage;
use coverage::sub_goals::params::FollowParams;
use coverage::sub_goals::site::Site;

pub use params::KeyedCoverageParams;

/// Process of the keyed coverage planner.
pub type KeyedCoveragePlanner = Follower<KeyedGoals>;

/// Sub-goals of [`KeyedCoverage`].
#[derive(Debug)]
pub struct KeyedGoals;

impl Design for KeyedGoals {
    const NAME: &'static str = "coverage_keyed";
    const SUMMARY: &'static str =
        "covers a workplace fast, by sub-goals that only its key predicts";

    type Params = KeyedCoverageParams;
    type Goals = KeyedCoverage;

    fn follow(params: &KeyedCoverageParams) -> FollowParams {
        params.follow
    }

    fn goals(
        params: &KeyedCoverageParams,
        site: &Site,
        seed: u64,
        before: Option<KeyedCoverage>,
    ) -> Result<KeyedCoverage, DesignError> {
        let (workplace, parts) = (&site.workplace, &site.decomposition);
        let made = if let Some(before) = before {
            before.moved(workplace, parts, site.start)
        } else {
            let key = Key::secret(crate::own_key(params.key, site), seed)?;
            // Legs keep the margin; the body covers the area.
            let disc = workplace.radius() - params.follow.margin;
            KeyedCoverage::new(
                workplace,
                parts,
                site.start,
                disc,
                key,
                params.goals.clone(),
            )
        };
        let made = made.map(|planner| {
            if params.track {
                planner.tracking()
            } else {
                planner
            }
        });
        Ok(made?)
    }
}
