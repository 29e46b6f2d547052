//! The process that plans minimum-time trajectories ([`trajectory`]) for other processes.
//!
//! [`wire`] converts requests to problems and plans to answers; [`service`] answers several
//! requests in parallel.

pub mod params;
pub mod process;
pub mod service;
pub mod wire;

pub use params::OptimiserParams;
