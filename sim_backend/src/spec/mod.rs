//! Specification of a world: every struct here is a table of the scenario.
//!
//! Unknown keys are errors. Each field declares its range and unit; [`parameters::check`] names the
//! field, the value and the expected range, so that errors are reported before the run starts.

mod condition;
mod coverage;
mod rules;

pub use condition::Condition;
pub use coverage::CoverageSpec;
pub use rules::{CaptureSpec, MissionEnd, ObstacleResponse, OutOfPlay, RulesSpec};

use geometry::map::MapSpec;
use robot::spec::RobotSpec;
use serde::{Deserialize, Serialize};

/// All inputs of [`World::new`](crate::world::World::new).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorldSpec {
    /// The world map: a file, vectors, or an occupancy grid.
    pub map: MapSpec,
    /// The robots; a robot's index in this list is its index everywhere.
    pub robots: Vec<RobotSpec>,
    /// Capture, exits, time limit and contact.
    #[serde(default)]
    pub rules: RulesSpec,
    /// Seed of all noise in the world (actuators, scans, odometry); each robot and sensor draws
    /// from its own stream of it.
    #[serde(default)]
    pub seed: u64,
}
