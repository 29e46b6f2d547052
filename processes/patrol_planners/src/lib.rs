//! The patrol planners (cat-map patrol paper), each in processes of its own.
//!
//! [`PatrolAwg`] goes along a zig-zag of additional waypoints: lap after lap, no two alike, around
//! obstacles, within the time ordered. [`PatrolFto`] goes past fictive temporary obstacles, alone or
//! mixed with additional waypoints (§5.2 and §6). [`patrol`] makes waypoints and fictive obstacles,
//! the waypoint driver of [`steering`] drives; [`process`] wires both to their topics.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod awg;
mod check;
mod fto;
pub mod process;

use parameters::ParamsError;
use patrol::mission::MissionError;
use thiserror::Error;

pub use awg::{Pace, PatrolAwg, PatrolAwgParams, SHOWN};
pub use fto::{PatrolFto, PatrolFtoParams, Protection};

/// Why a robot cannot patrol.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PatrolError {
    /// What was ordered cannot be.
    #[error("mission: {0}")]
    Mission(#[from] MissionError),
    /// A parameter or a limit of the robot is out of its range.
    #[error(transparent)]
    Params(#[from] ParamsError),
}
