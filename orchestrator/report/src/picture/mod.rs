//! One picture of a run from its log: the map, the trails, the robots' positions, captures and
//! escapes; of patrols and coverage the contour, danger zones, rectangles, waypoints and swept ground.
//!
//! * [`RunTrace::read`] reads the content of the picture from a log, in bounded memory;
//! * [`RunTrace::before_run`] takes it from a scenario, without a run; [`RunTrace::show`] from a world
//!   that is being simulated;
//! * [`fn@draw`] draws it, as a pure function;
//! * [`save`] writes it to a file. On an error, no file remains.

mod bands;
mod before_run;
mod draw;
mod draw_layers;
mod draw_task;
mod file;
mod labels;
pub(crate) mod layers;
mod layout;
mod legend;
mod of_world;
mod read;
mod signs;
pub(crate) mod trace;
mod trail;

#[cfg(test)]
mod tests;

pub use self::draw::draw;
pub use crate::run_model::{
    Cells, PlaceTrace, StaticObstacle, StaticScene, TaskTrace, WaypointTrace,
};
pub use ::draw::raster::encoded;
pub use file::save;
pub use layers::{DominanceTrace, PlanTrace, TreeTrace, VerdictTrace};
pub use trace::{BeliefTrace, Mark, MarkKind, RobotTrace, RunTrace};
pub use trail::{Trail, TrailPoint};
