//! Covers a workplace fast, by sub-goals that an observer who knows the method but not the key does
//! not predict ([`coverage::keyed`]).

pub mod params;

use crate::follower::Follower;
use chaotic_maps::Key;
use coverage::keyed::KeyedCoverage;
use coverage::sub_goals::design::{Design, Site};
use coverage::sub_goals::params::FollowParams;

pub use params::KeyedCoverageParams;

/// The keyed coverage planner in its process.
pub type KeyedCoveragePlanner = Follower<Keyed>;

/// Sub-goals of [`KeyedCoverage`].
#[derive(Debug)]
pub struct Keyed;

impl Design for Keyed {
    type Params = KeyedCoverageParams;
    type Goals = KeyedCoverage;

    fn validate(params: &KeyedCoverageParams) -> Result<(), String> {
        params.validate().map_err(|e| e.to_string())
    }

    fn follow(params: &KeyedCoverageParams) -> FollowParams {
        params.follow
    }

    fn goals(
        params: &KeyedCoverageParams,
        site: &Site,
        seed: u64,
        before: Option<KeyedCoverage>,
    ) -> Result<KeyedCoverage, String> {
        let (workplace, parts) = (&site.workplace, &site.decomposition);
        let made = if let Some(before) = before {
            before.moved(workplace, parts, site.start)
        } else {
            let key = Key::secret(params.key, seed).map_err(|e| e.to_string())?;
            // Legs keep the margin; what is covered is covered by the body.
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
        made.map_err(|e| e.to_string())
    }
}
