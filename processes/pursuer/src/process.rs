//! Connects [`Pursuer`] to its topics: state, map and beliefs in, command and plan out.

use planner::{Declaration, Input, Planner, PlannerError, limits};
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use pursuit_evasion::pursuit::{Pursuer, PursuerParams};
use runtime::config::RobotInfo;

/// Process of one Police robot.
#[derive(Debug)]
pub struct PursuerPlanner(Pursuer);

impl Planner for PursuerPlanner {
    const NAME: &'static str = "pursuer";
    const SUMMARY: &'static str = "chases evaders as one of a team";

    type Params = PursuerParams;

    fn presets() -> Vec<(&'static str, PursuerParams)> {
        vec![("paper", PursuerParams::paper())]
    }

    fn declare(params: &PursuerParams) -> Declaration {
        Declaration::default().reads_if(params.needs_beliefs(), Input::BELIEFS)
    }

    fn new(params: &PursuerParams, robot: &RobotInfo, seed: u64) -> Result<Self, PlannerError> {
        Ok(Self(Pursuer::new(*params, limits(robot)?, seed)?))
    }

    fn prepare(&mut self, map: &PlannerMap, robot: &RobotInfo) {
        self.0.prepare(map, robot.model.radius);
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.0.command(map, view)
    }
}
