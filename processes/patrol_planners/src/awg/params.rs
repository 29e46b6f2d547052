//! Parameters of the patrol.

use parameters::{Parameters, ParamsError, within};
use patrol::mission::MissionParams;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use steering::waypoint_driver::DriverParams;

/// How fast the patrol goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Pace {
    /// Each waypoint when it is due ([`patrol::awg::Awg::due_s`]), so that an ally with the key knows
    /// where the robot is at any time. The clock starts when the robot sets out from the start of
    /// the contour; before, and when it is late, it drives as fast as it can.
    #[default]
    Clock,
    /// As fast as the robot can.
    Fastest,
}

/// Parameters of a [`PatrolAwg`](crate::PatrolAwg).
///
/// ```toml
/// mission = { contour = [[5, 0], [0, 5], [5, 10]], t_max = 60 }
/// obstacles_known = true
/// driver = { go_to = { arrived = 0.1 } }
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PatrolAwgParams {
    /// What is patrolled, in which time, with which key.
    pub mission: MissionParams,
    /// How fast it goes.
    pub pace: Pace,
    /// Whether the robot knows the obstacles of the map: then additional waypoints inside them are
    /// left out at once, otherwise when they are not reached in time.
    pub obstacles_known: bool,
    /// How waypoints are driven to; `driver.go_to.arrived` is the distance at which one is reached.
    pub driver: DriverParams,
}

impl Parameters for PatrolAwgParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        self.mission.check_relations().map_err(within("mission"))
    }
}
