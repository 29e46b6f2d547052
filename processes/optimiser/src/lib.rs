//! The process that plans minimum-time trajectories ([`trajectory`]) for others.
//!
//! [`wire`] turns requests into problems and plans into answers; [`service`] answers several requests
//! at once.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod params;
pub mod process;
pub mod service;
pub mod wire;

pub use params::OptimiserParams;
