//! Covers a workplace by chaotic sub-goals (Chebyshev coverage paper), in a process of its own.
//!
//! [`design`] makes the sub-goals, by the plans of [`coverage`]; the process is that of all planners
//! of sub-goals ([`sub_goals`]).

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod design;
pub mod params;

#[cfg(test)]
mod tests;

pub use design::{Chebyshev, ChebyshevPlanner};
pub use params::ChebyshevParams;
