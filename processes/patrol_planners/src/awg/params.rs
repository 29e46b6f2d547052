//! Parameters of the patrol.

use avoidance::waypoint_driver::DriverParams;
use parameters::{Parameters, ParamsError, within};
use patrol::mission::MissionParams;

use crate::pursue::PursueParams;

parameters::choice! {
    /// Speed of the patrol.
    pub enum Pace {
        /// Each waypoint when it is due ([`patrol::awg::Awg::due_s`]), so that an ally with the key can
        /// compute the robot's position at any time. The clock starts when the robot sets out from the
        /// start of the contour; before, and when it is late, it drives as fast as it can.
        #[default]
        Clock,
        /// As fast as the robot can.
        Fastest,
    }
}

parameters::table! {
    /// Parameters of a [`PatrolAwg`](crate::PatrolAwg).
    ///
    /// ```toml
    /// mission = { contour = [[5, 0], [0, 5], [5, 10]], t_max = 60 }
    /// obstacles_known = true
    /// driver = { go_to = { arrived = 0.1 } }
    /// ```
    pub struct PatrolAwgParams {
        /// Route, duration and key of the patrol.
        pub mission: MissionParams,
        /// Speed of the patrol.
        pub pace: Pace,
        /// `true` if the robot knows the obstacles of the map. Additional waypoints inside them are
        /// then left out at once, otherwise when they are not reached in time.
        pub obstacles_known: bool,
        /// Driver to waypoints; `driver.go_to.arrived` is the distance at which one is reached.
        pub driver: DriverParams,
        /// Pursuit of the intruders that the guards of a team of pursuers sight, with a `perception` process: the nearest guard
        /// of the team pursues, the others divide the round among them, and all return to it. None if absent.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub pursue: Option<PursueParams>,
    }
}

impl Parameters for PatrolAwgParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        self.mission.check_relations().map_err(within("mission"))
    }
}
