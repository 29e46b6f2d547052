//! The patrol planners (cat-map patrol paper), one process each.
//!
//! [`PatrolAwg`] drives a zig-zag of additional waypoints: every lap is different, avoids obstacles
//! and keeps to the ordered time. [`PatrolFto`] drives past fictive temporary obstacles, alone or
//! mixed with additional waypoints (§5.2 and §6). A [`Guard`] patrols as [`PatrolAwg`] and pursues intruders. [`patrol`] makes waypoints and fictive obstacles,
//! the waypoint driver of `avoidance` drives; [`process`] connects both to their topics.

mod awg;
pub mod check;
mod fto;
mod guard;
pub mod process;
mod pursue;
mod round;

use parameters::ParamsError;
use patrol::mission::MissionError;
use thiserror::Error;

pub use awg::{Pace, PatrolAwg, PatrolAwgParams, SHOWN};
pub use fto::{PatrolFto, PatrolFtoParams, Protection};
pub use guard::Guard;
pub use pursue::PursueParams;

/// Reasons for which a robot cannot patrol.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PatrolError {
    /// Impossible mission.
    #[error("mission: {0}")]
    Mission(#[from] MissionError),
    /// A parameter or a limit of the robot is out of its range.
    #[error(transparent)]
    Params(#[from] ParamsError),
}
