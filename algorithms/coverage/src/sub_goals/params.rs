//! Parameters that all planners of sub-goals share.

use crate::workplace::MIN_TOLERANCE;
use parameters::{Parameters, ParamsError, above, at_least, positive, within};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use steering::go_to::GoToParams;
use steering::path_tracking::TrackingParams;
use steering::waypoint_driver::DriverParams;

/// How the robot gets from sub-goal to sub-goal (Chebyshev coverage paper, Fig. 9).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// Straight legs; it stops and turns at each sub-goal. Goes around obstacles that its range
    /// sensor sees.
    #[default]
    Linear,
    /// Arcs in place of the corners where they fit; it passes by the sub-goals. Knows only the
    /// obstacles of the map.
    Arc,
}

/// Parameters that all planners of sub-goals share.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FollowParams {
    /// How far rectangles may stick out of the obstacles that they stand for.
    #[schemars(transform = at_least(MIN_TOLERANCE).unit("m"))]
    pub tolerance: f64,
    /// Distance that the robot's body keeps from obstacles and walls where it is planned to be: a
    /// robot on wheels strays from its legs.
    #[schemars(transform = at_least(0).unit("m"))]
    pub margin: f64,
    /// The way between sub-goals.
    pub interpolation: Interpolation,
    /// An arc passes its sub-goal by this at most.
    #[schemars(transform = above(0).unit("m"))]
    pub most_miss: f64,
    /// How straight legs are driven.
    pub driver: DriverParams,
    /// How arcs are driven; `arrived` is also the tolerance of corners that are no arcs.
    pub tracking: TrackingParams,
}

impl Default for FollowParams {
    fn default() -> Self {
        Self {
            tolerance: 0.1,
            margin: 0.05,
            interpolation: Interpolation::default(),
            most_miss: 0.1,
            // Turned towards the next sub-goal before it sets out, it does not bulge out of its leg.
            driver: DriverParams {
                go_to: GoToParams {
                    turn_on_spot: 0.2,
                    ..GoToParams::default()
                },
                ..DriverParams::default()
            },
            tracking: TrackingParams {
                // Arcs are small; a far point of them would be reached by cutting across.
                look_ahead: 0.05,
                look_ahead_time_s: 0.1,
                least_look_ahead: 0.03,
                ..TrackingParams::default()
            },
        }
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
