//! Connects [`Evader`] to its topics: state and map in, command and plan out.

use planner::{Planner, PlannerError, limits};
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use runtime::config::RobotInfo;

use crate::{Evader, EvaderParams};

/// Process of one evader.
#[derive(Debug)]
pub struct PotentialPlanner(Evader);

impl Planner for PotentialPlanner {
    const NAME: &'static str = "evader_potential";
    const SUMMARY: &'static str = "flees to the nearest exit on a potential field";

    type Params = EvaderParams;

    fn presets() -> Vec<(&'static str, EvaderParams)> {
        vec![("paper", EvaderParams::paper())]
    }

    fn new(params: &EvaderParams, robot: &RobotInfo, seed: u64) -> Result<Self, PlannerError> {
        Ok(Self(Evader::new(*params, limits(robot)?, seed)?))
    }

    fn prepare(&mut self, map: &PlannerMap, robot: &RobotInfo) {
        self.0.prepare(map, robot.model.radius);
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.0.command(map, view)
    }
}
