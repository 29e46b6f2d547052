//! The process of a team's line-of-sight perception: sightings and one belief per opponent.
//!
//! The computation is in the `tracking` crate; this crate connects it to its topics.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod process;
