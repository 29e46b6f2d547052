//! Parameters of the patrol.

use avoidance::waypoint_driver::DriverParams;
use parameters::{Parameters, ParamsError, within};
use patrol::fto::FtoParams;
use patrol::mission::MissionParams;
use patrol::mixed::MixedParams;

use crate::check::Waypoints;

parameters::choice! {
    /// Means by which the patrol is hard to predict.
    pub enum Protection {
        /// Fictive obstacles wherever there is a threat: the baseline.
        #[default]
        FictiveObstacles,
        /// Additional waypoints, and fictive obstacles along large real ones ([`patrol::mixed`]).
        Mixed,
    }
}

impl Protection {
    /// The part of the protection that waypoints provide.
    pub(crate) fn waypoints(self) -> Waypoints {
        match self {
            Self::FictiveObstacles => Waypoints::Contour,
            Self::Mixed => Waypoints::ZigZag,
        }
    }
}

parameters::table! {
    /// Parameters of a [`PatrolFto`](crate::PatrolFto).
    ///
    /// ```toml
    /// protection = "mixed"
    /// mission = { contour = [[1, 1], [1, 11], [11, 11], [11, 1]], t_max = 100 }
    /// fto = { radius = 0.2 }
    /// ```
    pub struct PatrolFtoParams {
        /// Means by which it is hard to predict.
        pub protection: Protection,
        /// Route of the patrol; only the mixture uses width, key and preset.
        pub mission: MissionParams,
        /// The fictive obstacles.
        pub fto: FtoParams,
        /// Legs of the mixture that get them.
        pub mixed: MixedParams,
        /// `true` if the robot knows the obstacles of the map.
        pub obstacles_known: bool,
        /// Driver to waypoints; `driver.go_to.arrived` is the distance at which one is reached.
        pub driver: DriverParams,
    }
}

impl Parameters for PatrolFtoParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        self.mission.check_relations().map_err(within("mission"))?;
        self.fto.check_relations().map_err(within("fto"))
    }
}
