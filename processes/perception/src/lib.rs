//! The process of a team's line-of-sight perception: sightings and one belief per opponent.
//!
//! What it computes is in the `tracking` crate; here it meets its topics.

pub mod process;
