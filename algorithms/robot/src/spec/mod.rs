//! Specification of a robot: every struct here is a table of the scenario.
//!
//! Unknown keys are errors. Each field declares its range and unit; [`parameters::check`] names the
//! field, the value and the expected range, so that errors are reported before the run starts.

mod model;
mod robot;
mod sensor;

pub use model::{Preset, RobotModel};
pub use robot::{ActuatorSpec, LimitsSpec, RobotSpec};
pub use sensor::{MAX_BEAMS, OdometrySpec, ScanSpec};
