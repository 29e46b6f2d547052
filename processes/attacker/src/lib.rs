//! Adversaries that attack the places of a patrol.
//!
//! They see the poses of the guards, learn when places are visited, and choose place and time of their attacks
//! ([`patrol::attack`]). Whether an attack is detected is judged elsewhere.

pub mod params;
pub mod process;

pub use params::AttackerParams;
