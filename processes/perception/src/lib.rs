//! The process of a team's line-of-sight perception: sightings and one belief per opponent.
//!
//! What it computes is in the `tracking` crate; here it meets its topics.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod process;
