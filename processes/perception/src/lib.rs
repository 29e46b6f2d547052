//! Line-of-sight perception: visibility, sightings and one particle filter per opponent.
//!
//! A team sees its opponents through a simulated sensor whose quality depends on the line of sight
//! ([`sighting`], on [`sim_backend::visibility`]), and keeps one belief per opponent
//! ([`particle_filter`]). [`tracker::Perception`] does both for a tick. Everything is a function of
//! its inputs and a ChaCha8 stream per opponent.

pub mod belief;
pub mod fast;
pub mod memo;
pub mod params;
pub mod particle_filter;
pub mod process;
pub mod sighting;
pub mod space;
pub mod tracker;
pub mod watch;
