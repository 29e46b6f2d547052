//! Police: potential-field pursuit of exact or believed targets.
//!
//! Every Police robot runs its own [`Pursuer`]. Per tick it
//!
//! 1. agrees with its colleagues, without talking to them, on who chases whom ([`assignment`]);
//! 2. turns what is known of its target into goals somewhat ahead of it ([`goals`]);
//! 3. follows attraction to the goals + repulsion from colleagues + repulsion from obstacles, by
//!    feedback linearisation ([`chase`]).
//!
//! The method is the chasing-game paper's (§III-B); its exact parameters are
//! [`PursuerParams::paper`], every deviation of the defaults is a named parameter.

pub mod assignment;
pub mod chase;
pub mod goals;
pub mod params;
pub mod process;

pub use chase::Pursuer;
pub use params::PursuerParams;
