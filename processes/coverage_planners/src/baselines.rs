//! Baselines of coverage: [`Boustrophedon`] is the most efficient and the most predictable,
//! [`RandomBounce`] is the method of cleaning robots, [`Uniform`] is the least predictable.

pub mod params;

use core::marker::PhantomData;

use crate::design::Design;
use crate::error::DesignError;
use crate::follower::Follower;
use chaotic_maps::Key;
use coverage::boustrophedon;
use coverage::random_bounce::BounceRule;
use coverage::sub_goals::params::FollowParams;
use coverage::sub_goals::site::Site;
use coverage::uniform::Uniformly;
use coverage::wander::{Rule, Wanderer};

pub use params::{BoustrophedonParams, RandomParams};

/// Process of the boustrophedon planner.
pub type BoustrophedonPlanner = Follower<Boustrophedon>;

/// Process of the random-bounce planner.
pub type RandomBouncePlanner = Follower<RandomBounce>;

/// Process of the planner with independent uniform sub-goals.
pub type UniformPlanner = Follower<Uniform>;

/// Parallel lanes.
#[derive(Debug)]
pub struct Boustrophedon;

impl Design for Boustrophedon {
    const NAME: &'static str = "coverage_boustrophedon";
    const SUMMARY: &'static str =
        "covers a workplace in parallel lanes: the fastest, and the easiest to predict";

    type Params = BoustrophedonParams;
    type Goals = boustrophedon::Boustrophedon;

    fn follow(params: &BoustrophedonParams) -> FollowParams {
        params.follow
    }

    fn goals(
        params: &BoustrophedonParams,
        site: &Site,
        _seed: u64,
        before: Option<Self::Goals>,
    ) -> Result<Self::Goals, DesignError> {
        let (workplace, parts) = (&site.workplace, &site.decomposition);
        let made = if let Some(before) = before {
            before.moved(workplace, parts, site.start)
        } else {
            // Legs keep the margin; the body covers the area.
            let disc = workplace.radius() - params.follow.margin;
            Self::Goals::new(workplace, parts, site.start, disc)
        };
        Ok(made?)
    }
}

/// Planner that draws its sub-goals by a rule without memory.
#[derive(Debug)]
pub struct Memoryless<R>(PhantomData<R>);

/// Straight to the next wall, then away at a random angle.
pub type RandomBounce = Memoryless<BounceRule>;

/// Independent uniform sub-goals.
pub type Uniform = Memoryless<Uniformly>;

/// A rule, as a kind of process.
pub trait RandomKind: Rule + 'static {
    /// As [`Design::NAME`].
    const NAME: &'static str;
    /// As [`Design::SUMMARY`].
    const SUMMARY: &'static str;
}

impl RandomKind for BounceRule {
    const NAME: &'static str = "coverage_random_bounce";
    const SUMMARY: &'static str = "drives straight from wall to wall, away at random angles";
}

impl RandomKind for Uniformly {
    const NAME: &'static str = "coverage_uniform";
    const SUMMARY: &'static str = "drives to independent, uniformly random sub-goals";
}

impl<R: RandomKind> Design for Memoryless<R> {
    const NAME: &'static str = R::NAME;
    const SUMMARY: &'static str = R::SUMMARY;

    type Params = RandomParams;
    type Goals = Wanderer<R>;

    fn follow(params: &RandomParams) -> FollowParams {
        params.follow
    }

    fn goals(
        params: &RandomParams,
        site: &Site,
        seed: u64,
        before: Option<Self::Goals>,
    ) -> Result<Self::Goals, DesignError> {
        let (workplace, parts) = (&site.workplace, &site.decomposition);
        if let Some(before) = before {
            return Ok(before.moved(workplace, parts, site.start));
        }
        let secret = Key::secret(crate::own_key(params.key, site), seed)?;
        Ok(Wanderer::new(workplace, parts, site.start, secret))
    }
}
