//! Police: potential-field pursuit of exact or believed targets.
//!
//! Every robot of the Police has its own [`Pursuer`]. Per tick it
//!
//! 1. agrees with its colleagues, without messages, on the target of each ([`assignment`]) and the
//!    escape path that each cuts off ([`cut_off`]);
//! 2. converts the information on its target to goals somewhat ahead of it ([`goals`]);
//! 3. follows attraction to the goals + repulsion from colleagues + repulsion from obstacles, by
//!    feedback linearisation (`chase`).
//!
//! The method is the chasing-game paper's (§III-B); its exact parameters are
//! [`PursuerParams::paper`], every deviation of the defaults is a named parameter. Cutting off is an
//! addition to the paper; it is off by default.

pub mod assignment;
mod chase;
pub mod cut_off;
pub mod goals;
pub mod matching;
pub mod params;
mod slots;

pub use chase::Pursuer;
pub use params::PursuerParams;
