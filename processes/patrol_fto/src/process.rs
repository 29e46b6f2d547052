//! Wires [`PatrolFto`] to its topics: state, map and scan in; command, plan and waypoints out.

use guidance::map::PlannerMap;
use guidance::steering::Steering;
use guidance::view::View;
use guidance::waypoint::WaypointReport;
use kit::config::RobotInfo;
use kit::planner::{Planner, PlannerInputs};
use patrol::mission::Drive;

use crate::{PatrolFto, PatrolFtoParams};

/// One robot on patrol in its process.
#[derive(Debug)]
pub struct PatrolFtoPlanner(PatrolFto);

impl Planner for PatrolFtoPlanner {
    type Params = PatrolFtoParams;

    const WAYPOINTS: usize = 64;

    fn inputs(params: &PatrolFtoParams) -> PlannerInputs {
        PlannerInputs {
            scans: true,
            shapes: params.obstacles_known,
            ..PlannerInputs::default()
        }
    }

    fn new(params: &PatrolFtoParams, robot: &RobotInfo, seed: u64) -> Result<Self, String> {
        if robot.beams == 0 {
            return Err(format!(
                "{} has no range scanner, without which it cannot see fictive obstacles: give it \
                 a `scan` table",
                robot.name
            ));
        }
        let drive = Drive::of(&robot.model).map_err(|error| format!("{}: {error}", robot.name))?;
        PatrolFto::new(params, &drive, &robot.model, seed)
            .map(Self)
            .map_err(|error| error.to_string())
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.0.steer(map, view)
    }

    fn waypoints(&mut self) -> &[WaypointReport] {
        self.0.reports()
    }
}
