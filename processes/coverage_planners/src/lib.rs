//! The coverage planners, one process each.
//!
//! [`chebyshev`] covers by chaotic sub-goals (Chebyshev coverage paper); [`keyed`] covers fast, by
//! sub-goals that only its key predicts; [`baselines`] are for comparison. Each makes its sub-goals
//! with [`coverage`]; [`follower::Follower`] is their common process.

pub mod baselines;
pub mod chebyshev;
mod check;
pub mod design;
mod error;
pub mod follower;
pub mod keyed;
mod team;

use chaotic_maps::Key;
use coverage::sub_goals::site::Site;
use parameters::ParamsError;

pub use baselines::{
    Boustrophedon, BoustrophedonParams, BoustrophedonPlanner, RandomBounce, RandomBouncePlanner,
    RandomParams, Uniform, UniformPlanner,
};
pub use chebyshev::{Chebyshev, ChebyshevParams, ChebyshevPlanner};
pub use error::DesignError;
pub use keyed::{KeyedCoverageParams, KeyedCoveragePlanner, KeyedGoals};

/// Rejects keys of generators that are not secret.
fn require_secret(key: Option<Key>) -> Result<(), ParamsError> {
    let expected = "`keyed:` and 64 hexadecimal digits: no other generator is secret";
    match key {
        Some(key) if !matches!(key, Key::Keyed { .. }) => {
            Err(ParamsError::new("key", &key, expected))
        }
        _ => Ok(()),
    }
}

/// Returns the key of a robot of a team, if its parameters give one.
fn own_key(key: Option<Key>, site: &Site) -> Option<Key> {
    key.map(|key| key.of_robot(site.part as u64))
}

#[cfg(test)]
mod tests;
