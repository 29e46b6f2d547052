//! The coverage planners, each in processes of its own.
//!
//! [`chebyshev`] covers by chaotic sub-goals (Chebyshev coverage paper), [`keyed`] fast and by
//! sub-goals that only its key predicts; [`baselines`] are what both are compared with. Each makes
//! its sub-goals by [`coverage`]; the process of all is [`follower::Follower`].

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod baselines;
pub mod chebyshev;
mod check;
pub mod design;
pub mod follower;
pub mod keyed;

use chaotic_maps::Key;
use parameters::ParamsError;

pub use baselines::{
    Boustrophedon, BoustrophedonParams, BoustrophedonPlanner, RandomBounce, RandomBouncePlanner,
    RandomParams, Uniform, UniformPlanner,
};
pub use chebyshev::{Chebyshev, ChebyshevParams, ChebyshevPlanner};
pub use keyed::{Keyed, KeyedCoverageParams, KeyedCoveragePlanner};

/// Refuses keys of generators that keep no secret.
fn require_secret(key: Option<Key>) -> Result<(), ParamsError> {
    let expected = "`keyed:` and 64 hexadecimal digits: no other generator is secret";
    match key {
        Some(key) if !matches!(key, Key::Keyed { .. }) => {
            Err(ParamsError::new("key", &key, expected))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;
