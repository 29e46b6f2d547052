//! Police: potential-field pursuit of exact or believed targets.
//!
//! Every Police robot runs its own [`Pursuer`]. Per tick it
//!
//! 1. agrees with its colleagues, without talking to them, on who guards the exits
//!    ([`exit_guard`]), who of the others chases whom ([`assignment`]) and who of those cuts off
//!    which way out ([`cut_off`]);
//! 2. turns what is known of its target into goals somewhat ahead of it ([`goals`]), or where it
//!    can be met first ([`interception`]);
//! 3. follows attraction to the goals + repulsion from colleagues + repulsion from obstacles, by
//!    feedback linearisation ([`chase`]).
//!
//! The method is the chasing-game paper's (§III-B); its exact parameters are
//! [`PursuerParams::paper`], every deviation of the defaults is a named parameter. Guards, cuts
//! and interceptions are not the paper's; they are off unless asked for.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod assignment;
pub mod chase;
pub mod cut_off;
pub mod exit_guard;
pub mod exit_site;
pub mod goals;
pub mod interception;
pub mod matching;
pub mod params;
pub mod process;
mod slots;
pub mod targets;

pub use chase::Pursuer;
pub use params::PursuerParams;
