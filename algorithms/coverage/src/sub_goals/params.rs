//! Parameters that all planners of sub-goals share.

use crate::workplace::MIN_TOLERANCE;
use avoidance::waypoint_driver::DriverParams;
use control::go_to::GoToParams;
use control::path_tracking::TrackingParams;
use parameters::{Parameters, ParamsError, above, at_least, positive, within};

parameters::choice! {
    /// Motion from sub-goal to sub-goal (Chebyshev coverage paper, Fig. 9).
    pub enum Interpolation {
        /// Straight legs; the robot stops and turns at each sub-goal. It avoids obstacles that its range
        /// sensor detects.
        #[default]
        Linear,
        /// Arcs in place of the corners where they fit; the robot passes the sub-goals. It knows only
        /// the obstacles of the map.
        Arc,
    }
}

parameters::table! {
    /// Parameters that all planners of sub-goals share.
    #[derive(Copy)]
    pub struct FollowParams {
        /// Maximum distance by which rectangles extend beyond the obstacles that they represent.
        pub tolerance: f64 [at_least(MIN_TOLERANCE).unit("m")] = 0.1,
        /// Planned clearance of the robot's body from obstacles and walls: a robot on wheels deviates
        /// from its legs.
        pub margin: f64 [at_least(0).unit("m")] = 0.05,
        /// `true` to divide the workplace among the robots of a team that one kind covers with the same
        /// rectangles; `false`: each covers all of it.
        pub divide: bool = true,
        /// Path between sub-goals.
        pub interpolation: Interpolation,
        /// Maximum distance between an arc and its sub-goal.
        pub max_miss: f64 [above(0).unit("m")] = 0.1,
        /// Parameters of driving straight legs.
        // A robot that turns towards the next sub-goal before it starts does not bulge out of
        // its leg.
        pub driver: DriverParams = DriverParams {
            go_to: GoToParams {
                turn_on_spot: 0.2,
                ..GoToParams::default()
            },
            ..DriverParams::default()
        },
        /// Parameters of driving arcs; `arrived` is also the tolerance of corners without arcs.
        pub tracking: TrackingParams = TrackingParams {
            // Arcs are small; a far look-ahead would cut across them.
            look_ahead: 0.05,
            look_ahead_time_s: 0.1,
            min_look_ahead: 0.03,
            ..TrackingParams::default()
        },
    }
}

impl Parameters for FollowParams {
    fn check_relations(&self) -> Result<(), ParamsError> {
        self.tracking
            .check_relations()
            .map_err(within("tracking"))?;
        positive("tracking.speed_fraction", self.tracking.speed_fraction)
    }
}
