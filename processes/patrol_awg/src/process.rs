//! Wires [`PatrolAwg`] to its topics: state, map and scan in; command, plan and waypoints out.

use guidance::map::PlannerMap;
use guidance::steering::Steering;
use guidance::view::View;
use guidance::waypoint::WaypointReport;
use kit::config::RobotInfo;
use kit::planner::{PlannedPoint, Planner, PlannerInputs};

use crate::{PatrolAwg, PatrolAwgParams};

/// One robot on patrol in its process.
#[derive(Debug)]
pub struct PatrolAwgPlanner(PatrolAwg);

impl Planner for PatrolAwgPlanner {
    type Params = PatrolAwgParams;

    const WAYPOINTS: usize = 64;

    fn inputs(params: &PatrolAwgParams) -> PlannerInputs {
        PlannerInputs {
            scans: true,
            shapes: params.obstacles_known,
            ..PlannerInputs::default()
        }
    }

    fn new(params: &PatrolAwgParams, robot: &RobotInfo, seed: u64) -> Result<Self, String> {
        PatrolAwg::new(params, &robot.model, seed)
            .map(Self)
            .map_err(|error| error.to_string())
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.0.steer(map, view)
    }

    fn plan(&self, _: &Steering, out: &mut Vec<PlannedPoint>) {
        out.extend(self.0.ahead().map(|waypoint| PlannedPoint {
            at: waypoint.point,
            ..PlannedPoint::default()
        }));
    }

    fn waypoints(&mut self) -> &[WaypointReport] {
        self.0.reports()
    }
}
