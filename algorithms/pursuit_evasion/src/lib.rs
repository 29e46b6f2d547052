//! Evaders among pursuers, and their pursuers.
//!
//! - [`escape`]: drives to an exit that no pursuer can prevent;
//! - [`potential_evader`]: an evader that uses potential fields only;
//! - [`pursuit`]: pursuers that share evaders out and cut off their paths.
//!
//! All functions are pure: equal inputs give equal bits on every machine.

pub mod escape;
pub mod potential_evader;
pub mod pursuit;
