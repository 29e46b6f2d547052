//! Connects [`Braitenberg`] to its topics: state and scan in, command out.

use planner::{Declaration, Input, Planner, PlannerError, limits};
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use runtime::config::RobotInfo;

use crate::{Braitenberg, BraitenbergParams};

/// Process of one evader.
#[derive(Debug)]
pub struct BraitenbergPlanner(Braitenberg);

impl Planner for BraitenbergPlanner {
    const NAME: &'static str = "evader_braitenberg";
    const SUMMARY: &'static str = "flees by its range scan alone, away from near obstacles";

    type Params = BraitenbergParams;

    fn presets() -> Vec<(&'static str, BraitenbergParams)> {
        vec![("paper", BraitenbergParams::paper())]
    }

    fn declare(_: &BraitenbergParams) -> Declaration {
        Declaration::default().reads(Input::SCANS)
    }

    fn new(params: &BraitenbergParams, robot: &RobotInfo, seed: u64) -> Result<Self, PlannerError> {
        Ok(Self(Braitenberg::new(*params, limits(robot)?, seed)?))
    }

    fn steer(&mut self, _: &PlannerMap, view: &View<'_>) -> Steering {
        self.0.command(view)
    }
}
