//! Connects the planners to their topics: state, map and scan in; command, plan and waypoints out.

use geometry::map::MapSpec;
use patrol::mission::{Drive, MissionParams};
use planner::{
    Declaration, Input, Output, PlannedPoint, Planner, PlannerError, headed_for, limits,
};
use planner_view::event::RobotEvent;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use planner_view::waypoint::WaypointReport;
use robot::spec::RobotSpec;
use robot::team::Role;
use runtime::config::RobotInfo;
use runtime::kind::{Remark, Task, TaskFault, TaskSketch};

use crate::awg::MAX_REPORTS;
use crate::check::{Waypoints, check_task, task_remarks};
use crate::{Guard, PatrolAwg, PatrolAwgParams, PatrolFto, PatrolFtoParams};

/// Returns the declaration of a patrol: the exact shapes bound the zig-zag, and known obstacles are among them.
fn declare(mission: &MissionParams) -> Declaration {
    Declaration {
        lap_limit_s: Some(mission.t_max),
        ..Declaration::default()
    }
    .reads(Input::SCANS)
    .reads(Input::SHAPES)
    .writes(Output::waypoints(MAX_REPORTS))
}

/// Maximum number of events of a guard in a tick: a pursuit that ends, and one that begins.
const MAX_EVENTS: usize = 2;

/// Returns the contour and the danger zones of a patrol.
fn sketch(mission: &MissionParams) -> TaskSketch {
    let mut contour = mission.contour.clone();
    if mission.closed {
        contour.extend(mission.contour.first());
    }
    TaskSketch {
        contour,
        danger_zones: mission.danger_zones.0.clone(),
        ..TaskSketch::default()
    }
}

/// Process of one robot on patrol along the zig-zag, and in pursuit of intruders.
#[derive(Debug)]
pub struct PatrolAwgPlanner(Guard);

impl Planner for PatrolAwgPlanner {
    const NAME: &'static str = "patrol_awg";
    const SUMMARY: &'static str = "patrols a contour along a zig-zag that only its key predicts";

    type Params = PatrolAwgParams;

    fn sketch(params: &PatrolAwgParams, _: &RobotSpec, _: &MapSpec) -> TaskSketch {
        sketch(&params.mission)
    }

    fn check_task(params: &PatrolAwgParams, task: &Task<'_>, seed: u64) -> Result<(), TaskFault> {
        let role = task.robot.role();
        if params.pursue.is_some() && role != Role::Pursuer {
            let message = format!(
                "the role of {} is {}: expected pursuer; only pursuers of a hostile team catch intruders",
                task.robot.name,
                role.name()
            );
            return Err(TaskFault::param("pursue", &message));
        }
        let known = params.obstacles_known;
        check_task(&params.mission, &params.driver, known, task, seed)
    }

    fn remarks(params: &PatrolAwgParams, task: &Task<'_>, seed: u64) -> Vec<Remark> {
        let known = params.obstacles_known;
        let waypoints = Waypoints::ZigZag;
        task_remarks(
            &params.mission,
            &params.driver,
            known,
            waypoints,
            task,
            seed,
        )
    }

    fn declare(params: &PatrolAwgParams) -> Declaration {
        let declaration = declare(&params.mission);
        if params.pursue.is_none() {
            return declaration;
        }
        declaration
            .reads(Input::BELIEFS)
            .writes(Output::events(MAX_EVENTS))
    }

    fn new(params: &PatrolAwgParams, robot: &RobotInfo, seed: u64) -> Result<Self, PlannerError> {
        let patrol = PatrolAwg::new(params, &robot.model, seed).map_err(PlannerError::algorithm)?;
        let guard = Guard::new(patrol.in_team(&robot.companions));
        let Some(pursue) = &params.pursue else {
            return Ok(Self(guard));
        };
        let limits = limits(robot)?;
        guard
            .pursuing(pursue, &robot.companions, limits, seed)
            .map(Self)
            .map_err(PlannerError::algorithm)
    }

    fn prepare(&mut self, map: &PlannerMap, robot: &RobotInfo) {
        self.0.prepare(map, robot.model.radius);
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.0.steer(map, view)
    }

    fn plan(&self, steering: &Steering, out: &mut Vec<PlannedPoint>) {
        if self.0.is_in_pursuit() {
            return headed_for(steering, out);
        }
        out.extend(self.0.patrol().ahead().map(|waypoint| PlannedPoint {
            at: waypoint.point,
            ..PlannedPoint::default()
        }));
    }

    fn waypoints(&mut self) -> &[WaypointReport] {
        self.0.patrol().reports()
    }

    fn events(&mut self) -> &[RobotEvent] {
        self.0.events()
    }
}

/// Process of one robot on patrol past fictive obstacles.
#[derive(Debug)]
pub struct PatrolFtoPlanner(PatrolFto);

impl Planner for PatrolFtoPlanner {
    const NAME: &'static str = "patrol_fto";
    const SUMMARY: &'static str =
        "patrols a contour past fictive obstacles, or mixes them with a zig-zag";

    type Params = PatrolFtoParams;

    fn sketch(params: &PatrolFtoParams, _: &RobotSpec, _: &MapSpec) -> TaskSketch {
        sketch(&params.mission)
    }

    fn check_task(params: &PatrolFtoParams, task: &Task<'_>, seed: u64) -> Result<(), TaskFault> {
        let known = params.obstacles_known;
        check_task(&params.mission, &params.driver, known, task, seed)
    }

    fn remarks(params: &PatrolFtoParams, task: &Task<'_>, seed: u64) -> Vec<Remark> {
        let waypoints = params.protection.waypoints();
        task_remarks(
            &params.mission,
            &params.driver,
            false,
            waypoints,
            task,
            seed,
        )
    }

    fn declare(params: &PatrolFtoParams) -> Declaration {
        declare(&params.mission)
    }

    fn new(params: &PatrolFtoParams, robot: &RobotInfo, seed: u64) -> Result<Self, PlannerError> {
        if robot.beams == 0 {
            let reason = format!(
                "{} has no range scanner, without which it cannot see fictive obstacles: give it \
                 a `scan` table",
                robot.name
            );
            return Err(PlannerError::algorithm(reason));
        }
        let drive = Drive::from_model(&robot.model)
            .map_err(|error| PlannerError::of_robot(&robot.name, error))?;
        PatrolFto::new(params, &drive, &robot.model, seed)
            .map(|patrol| Self(patrol.in_team(&robot.companions)))
            .map_err(PlannerError::algorithm)
    }

    fn prepare(&mut self, map: &PlannerMap, _: &RobotInfo) {
        self.0.enter(map);
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.0.steer(map, view)
    }

    fn waypoints(&mut self) -> &[WaypointReport] {
        self.0.reports()
    }
}
