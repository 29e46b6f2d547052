//! Computations for published results that need no mission. The claims and pages that follow from them are those of
//! the Python package, `protean_robotics.lab`.
//!
//! - [`plans`]: single plans of the RRT* evaders of the chasing game;
//! - [`laps`]: laps of the zig-zag of the cat-map patrol paper;
//! - [`sequences`]: sequences of the Chebyshev coverage paper.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod laps;
pub mod plans;
pub mod sequences;
