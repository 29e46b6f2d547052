//! Police: potential-field pursuit of exact or believed targets.
//!
//! Every Police robot runs its own [`Pursuer`]. Per tick it
//!
//! 1. agrees with its colleagues, without messages, on the guards of the exits ([`exit_guard`]),
//!    the target of every chaser ([`assignment`]) and the escape path that each cuts off
//!    ([`cut_off`]);
//! 2. converts the information on its target to goals somewhat ahead of it ([`goals`]), or to the
//!    first meeting place ([`interception`]);
//! 3. follows attraction to the goals + repulsion from colleagues + repulsion from obstacles, by
//!    feedback linearisation ([`chase`]).
//!
//! The method is the chasing-game paper's (§III-B); its exact parameters are
//! [`PursuerParams::paper`], every deviation of the defaults is a named parameter. Guards, cuts and
//! interceptions are additions to the paper; they are off by default.

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
