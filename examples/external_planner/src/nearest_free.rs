//! Drives to the goal of the robot in the free direction that is nearest to the direction of the goal.
//!
//! A local method: it goes around single obstacles, but not out of a dead end.

use core::f64::consts::PI;

use planner::geometry::math;
use planner::geometry::region::Region;
use planner::nalgebra::{Point2, Vector2};
use planner::parameters::{Parameters, above, at_least};
use planner::control::go_to::{GoToParams, go_to};
use planner::{Limits, Planner, PlannerError, PlannerMap, RobotInfo, Steering, View, limits};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Directions that are tried on each side of the direction of the goal.
const DIRECTIONS: i32 = 24;

/// Parameters of [`NearestFree`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct NearestFreeParams {
    /// Distance for which a direction must be free, or up to the goal if that is nearer.
    #[schemars(transform = above(0.0).unit("m"))]
    pub look_ahead: f64,
    /// Distance that the robot's body keeps from obstacles; where it is nearer, it drives away from them.
    #[schemars(transform = at_least(0.0).unit("m"))]
    pub margin: f64,
    /// Distance to the centre of the goal at which the robot stops.
    #[schemars(transform = above(0.0).unit("m"))]
    pub arrived: f64,
}

impl Default for NearestFreeParams {
    fn default() -> Self {
        Self {
            look_ahead: 0.8,
            margin: 0.1,
            arrived: 0.05,
        }
    }
}

impl Parameters for NearestFreeParams {}

/// The planner of one robot.
#[derive(Debug)]
pub struct NearestFree {
    params: NearestFreeParams,
    limits: Limits,
    goal: Point2<f64>,
}

impl Planner for NearestFree {
    const NAME: &'static str = "my_planner";
    const SUMMARY: &'static str = "drives to its goal in the nearest free direction";

    type Params = NearestFreeParams;

    fn new(
        params: &NearestFreeParams,
        robot: &RobotInfo,
        _seed: u64,
    ) -> Result<Self, PlannerError> {
        let goal = robot.goal.as_ref().map(Region::center);
        Ok(Self {
            params: *params,
            limits: limits(robot)?,
            goal: goal.ok_or_else(|| PlannerError::of_robot(&robot.name, "it has no `goal`"))?,
        })
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        let Some(own) = view.own() else {
            return Steering::stop();
        };
        let here = own.pose.position();
        let offset = self.goal - here;
        let distance = offset.norm();
        if distance <= self.params.arrived {
            return Steering::stop();
        }
        let reach = self.params.look_ahead.min(distance);
        let toward = math::atan2(offset.y, offset.x);
        let mut points = (0..=DIRECTIONS).flat_map(|step| [step, -step]).map(|step| {
            let angle = toward + f64::from(step) * PI / f64::from(DIRECTIONS);
            here + Vector2::new(math::cos(angle), math::sin(angle)) * reach
        });
        let radius = own.radius + self.params.margin;
        let free = points.find(|point| map.line_is_clear(here, *point, radius));
        let away = || Some(here + map.away_from_obstacles(here)? * reach);
        let Some(waypoint) = free.or_else(away) else {
            return Steering::stop();
        };
        let params = GoToParams::default();
        Steering {
            command: go_to(&own.pose, waypoint, None, &self.limits, &params, view.dt),
            aim: Some(self.goal),
            waypoint: Some(waypoint),
            ..Steering::stop()
        }
    }
}
