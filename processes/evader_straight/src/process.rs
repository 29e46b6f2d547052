//! The process of the evader.

use planner::{Planner, PlannerInputs, limits};
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use runtime::config::RobotInfo;

use crate::StraightParams;
use crate::straight::command;

/// One evader in its process.
#[derive(Debug)]
pub struct StraightPlanner {
    params: StraightParams,
    limits: Limits,
}

impl Planner for StraightPlanner {
    const NAME: &'static str = "evader_straight";
    const SUMMARY: &'static str = "drives straight ahead and avoids nothing";

    type Params = StraightParams;

    fn inputs(_: &StraightParams) -> PlannerInputs {
        PlannerInputs::default()
    }

    fn new(params: &StraightParams, robot: &RobotInfo, _seed: u64) -> Result<Self, String> {
        Ok(Self {
            params: *params,
            limits: limits(robot)?,
        })
    }

    fn steer(&mut self, _: &PlannerMap, _: &View<'_>) -> Steering {
        Steering {
            command: command(&self.params, &self.limits),
            ..Steering::stop()
        }
    }
}
