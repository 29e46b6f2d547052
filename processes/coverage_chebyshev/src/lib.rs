//! Covers a workplace by chaotic sub-goals (Chebyshev coverage paper), in a process of its own.
//!
//! - [`params`]: what can be set;
//! - [`design`]: what a kind of coverage planner must say of itself, and the chaotic one;
//! - [`arc_driver`]: driving through sub-goals without stopping at them;
//! - [`process`]: the wiring, shared by all planners of sub-goals.

pub mod arc_driver;
pub mod design;
pub mod params;
pub mod process;

pub use params::{ChebyshevParams, FollowParams};
