//! Evader driven by a Braitenberg vehicle on its range scan.
//!
//! Five cones of the scan directly control forward speed and turning rate, after V. Braitenberg and
//! the chasing-game paper (§I-B, §III-E). There is no goal, no map and no model of the Police: an
//! exit is found by chance or not at all. [`cones`] reads the scan, [`vehicle`] computes the
//! speeds; the paper's exact formula is [`BraitenbergParams::paper`].

pub mod cones;
pub mod params;
pub mod process;
pub mod vehicle;

pub use params::BraitenbergParams;
pub use vehicle::Braitenberg;
