//! Connects [`Evader`] to its topics: state and map in, command and plan out.

use geometry::region::Region;
use planner::{Planner, PlannerError};
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use runtime::config::RobotInfo;

use crate::{Evader, ReachAvoidParams};

/// Process of one evader.
#[derive(Debug)]
pub struct ReachAvoidPlanner(Evader);

impl Planner for ReachAvoidPlanner {
    const NAME: &'static str = "evader_reach_avoid";
    const SUMMARY: &'static str =
        "flees along paths on which no pursuer can stop it, or to the place with the most time";

    type Params = ReachAvoidParams;

    fn new(params: &ReachAvoidParams, robot: &RobotInfo, _seed: u64) -> Result<Self, PlannerError> {
        Evader::new(*params, robot.model)
            .map(Self)
            .map_err(|e| PlannerError::of_robot(&robot.name, e))
    }

    fn rules(&mut self, exits: &[Region], capture_radius: f64) {
        self.0.rules(exits, capture_radius);
    }

    fn prepare(&mut self, map: &PlannerMap, robot: &RobotInfo) {
        self.0.prepare(map, robot.model.radius);
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.0.command(map, view)
    }
}
