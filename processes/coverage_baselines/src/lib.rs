//! Baselines of coverage in processes of their own: [`Boustrophedon`] is the most efficient and
//! hides nothing, [`RandomBounce`] is what cleaning robots do, [`Uniform`] hides the most. The
//! algorithms are in [`coverage`]; the wiring is that of all planners of sub-goals.

pub mod params;

#[cfg(test)]
mod tests;

use coverage::{boustrophedon, random_bounce, uniform};
use generators::{Key, KeyKind};
use sub_goals::design::{Design, Site};
use sub_goals::follower::Follower;
use sub_goals::params::FollowParams;

pub use params::{BoustrophedonParams, RandomParams};

/// The boustrophedon in its process.
pub type BoustrophedonPlanner = Follower<Boustrophedon>;

/// Random bounce in its process.
pub type RandomBouncePlanner = Follower<RandomBounce>;

/// Independent uniform sub-goals in their process.
pub type UniformPlanner = Follower<Uniform>;

/// Parallel lanes.
#[derive(Debug)]
pub struct Boustrophedon;

impl Design for Boustrophedon {
    type Params = BoustrophedonParams;
    type Goals = boustrophedon::Boustrophedon;

    fn validate(params: &BoustrophedonParams) -> Result<(), String> {
        params.validate().map_err(|e| e.to_string())
    }

    fn follow(params: &BoustrophedonParams) -> FollowParams {
        params.follow
    }

    fn goals(
        params: &BoustrophedonParams,
        site: &Site,
        _seed: u64,
        before: Option<Self::Goals>,
    ) -> Result<Self::Goals, String> {
        let (workplace, parts) = (&site.workplace, &site.decomposition);
        let made = if let Some(before) = before {
            before.moved(workplace, parts, site.start)
        } else {
            // Legs keep the margin; what is covered is covered by the body.
            let disc = workplace.radius() - params.follow.margin;
            Self::Goals::new(workplace, parts, site.start, disc, params.rounds)
        };
        made.map_err(|e| e.to_string())
    }
}

/// Straight to the next wall, then on at a random angle.
#[derive(Debug)]
pub struct RandomBounce;

impl Design for RandomBounce {
    type Params = RandomParams;
    type Goals = random_bounce::RandomBounce;

    fn validate(params: &RandomParams) -> Result<(), String> {
        params.validate().map_err(|e| e.to_string())
    }

    fn follow(params: &RandomParams) -> FollowParams {
        params.follow
    }

    fn goals(
        params: &RandomParams,
        site: &Site,
        seed: u64,
        before: Option<Self::Goals>,
    ) -> Result<Self::Goals, String> {
        let (workplace, parts) = (&site.workplace, &site.decomposition);
        Ok(match before {
            Some(before) => before.moved(workplace, parts, site.start),
            None => Self::Goals::new(workplace, parts, site.start, secret(params.key, seed)?),
        })
    }
}

/// Independent uniform sub-goals.
#[derive(Debug)]
pub struct Uniform;

impl Design for Uniform {
    type Params = RandomParams;
    type Goals = uniform::UniformGoals;

    fn validate(params: &RandomParams) -> Result<(), String> {
        params.validate().map_err(|e| e.to_string())
    }

    fn follow(params: &RandomParams) -> FollowParams {
        params.follow
    }

    fn goals(
        params: &RandomParams,
        site: &Site,
        seed: u64,
        before: Option<Self::Goals>,
    ) -> Result<Self::Goals, String> {
        let (workplace, parts) = (&site.workplace, &site.decomposition);
        Ok(match before {
            Some(before) => before.moved(workplace, parts, site.start),
            None => Self::Goals::new(workplace, parts, site.start, secret(params.key, seed)?),
        })
    }
}

/// The key of a stream: the one given, else one made from the seed of the run.
fn secret(key: Option<Key>, seed: u64) -> Result<[u8; 32], String> {
    match key.unwrap_or_else(|| Key::from_seed(KeyKind::Keyed, seed)) {
        Key::Keyed { key } => Ok(key),
        other => Err(format!("`key` is {other}, but must be keyed:<64 digits>")),
    }
}
