//! Evaders among pursuers.
//!
//! - [`escape`]: drives to an exit that no pursuer can prevent;
//! - [`potential_evader`]: an evader that uses potential fields only.
//!
//! All functions are pure: equal inputs give equal bits on every machine.

pub mod escape;
pub mod potential_evader;
