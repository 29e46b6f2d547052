//! Planner for `python_turn.py`: drives to the first exit, as the one in Python does.

use std::process::ExitCode;

use planner::control::go_to::{GoToParams, go_to};
use planner::geometry::region::Region;
use planner::nalgebra::Point2;
use planner::{
    Declaration, Input, Limits, Planner, PlannerError, PlannerMap, RobotInfo, Steering, View,
    limits,
};

/// The planner of one robot.
struct GoToExit {
    params: GoToParams,
    limits: Limits,
    exit: Option<Point2<f64>>,
}

impl Planner for GoToExit {
    const NAME: &'static str = "go_to_exit";
    const SUMMARY: &'static str = "drives to the first exit";

    type Params = GoToParams;

    fn declare(_: &GoToParams) -> Declaration {
        // As the one in Python, which may ask for exact paths.
        Declaration::default().reads(Input::SHAPES)
    }

    fn new(params: &GoToParams, robot: &RobotInfo, _seed: u64) -> Result<Self, PlannerError> {
        Ok(Self {
            params: *params,
            limits: limits(robot)?,
            exit: None,
        })
    }

    fn rules(&mut self, exits: &[Region], _: f64) {
        self.exit = exits.first().map(Region::center);
    }

    fn steer(&mut self, _: &PlannerMap, view: &View<'_>) -> Steering {
        let (Some(own), Some(exit)) = (view.own(), self.exit) else {
            return Steering::stop();
        };
        Steering {
            command: go_to(&own.pose, exit, None, &self.limits, &self.params, view.dt),
            ..Steering::stop()
        }
    }
}

fn main() -> ExitCode {
    planner::main::<GoToExit>()
}
