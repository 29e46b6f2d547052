//! The process of a team's line-of-sight perception: sightings and one belief per opponent.
//!
//! The computation is in the `tracking` crate; this crate connects it to its topics.

mod direct;
pub mod process;
