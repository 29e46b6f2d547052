//! A run as its log tells it, for pictures and pages: one pass over the log.
//!
//! * [`LoggedRun`] reads the log and passes its messages to consumers;
//! * [`Facts`] are those of the metadata and attachments: the manifest, the result, the scenario as far as it is drawn,
//!   and the description of the run ([`recorder::RunInfo`]);
//! * [`StaticScene`] and [`TaskTrace`] are the geometry below the robots.

mod facts;
mod logged_run;
mod scenario;
mod static_scene;
mod task;

pub(crate) use facts::Facts;
pub(crate) use logged_run::{LoggedRun, Purpose, is_near};
pub(crate) use scenario::LoggedScenario;
pub use static_scene::{Cells, StaticObstacle, StaticScene};
pub(crate) use static_scene::{corners, is_grid, rectangle};
pub use task::{PlaceTrace, TaskTrace, WaypointTrace};
