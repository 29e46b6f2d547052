//! Line-of-sight sightings and beliefs about robots that others watch.
//!
//! A simulated sensor gives sightings whose quality depends on the line of sight ([`sighting`], on
//! [`geometry::visibility`]), and a particle filter keeps one belief per robot watched
//! ([`particle_filter`]). [`tracker::Perception`] does both for a team and a tick. Everything is a
//! function of its inputs and a ChaCha8 stream per robot watched.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod belief;
pub mod fast;
pub mod params;
pub mod particle_filter;
pub mod sighting;
pub mod space;
pub mod tracker;
pub mod watch;
