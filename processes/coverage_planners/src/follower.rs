//! Process of planners of sub-goals. Inputs: states and map. Outputs: command, plan and the results
//! of the sub-goals.

use avoidance::waypoint_driver::{DriverOutput, Situation, WaypointDriver};
use coverage::goal::{Goal, GoalSource};
use geometry::map::{MapSpec, WorldMap};
use geometry::pose::Pose2;
use geometry::shape::Aabb;
use ipc_types::bus::Bus;
use nalgebra::Point2;
use planner::{Declaration, Input, Output, Planner, PlannerError, limits};
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use planner_view::waypoint::WaypointReport;
use robot::spec::RobotSpec;
use runtime::config::{ProcessConfig, RobotInfo};
use runtime::error::ProcessError;
use runtime::kind::{Task, TaskFault, TaskSketch};

use coverage::sub_goals::arc_driver::ArcDriver;
use coverage::sub_goals::params::{FollowParams, Interpolation};
use coverage::sub_goals::site::Site;

use crate::check::check_task;
use crate::design::Design;
use crate::error::DesignError;
use crate::team::Team;

/// Method of driving.
#[derive(Debug)]
enum Drive {
    Linear(Box<WaypointDriver>),
    Arc(Box<ArcDriver>),
}

/// Planner of sub-goals of some design, and the driver of its robot.
pub struct Follower<D: Design> {
    params: D::Params,
    follow: FollowParams,
    limits: Limits,
    radius: f64,
    seed: u64,
    drive: Drive,
    goals: Option<D::Goals>,
    /// Revision of the map for which the goals were made.
    revision: Option<u64>,
    team: Team,
    /// Last goal, at which the next leg begins (m).
    last: Option<Point2<f64>>,
    /// Position of the robot one tick ago (m).
    before: Option<Point2<f64>>,
    reports: Vec<WaypointReport>,
    failure: Option<ProcessError>,
}

impl<D: Design> Follower<D> {
    /// Returns its sub-goals from now on; `None` before the first map.
    pub fn goals(&mut self) -> Option<&mut D::Goals> {
        self.goals.as_mut()
    }

    fn driver(follow: &FollowParams, limits: Limits, radius: f64) -> Result<Drive, DesignError> {
        Ok(match follow.interpolation {
            Interpolation::Linear => {
                let driver = WaypointDriver::new(follow.driver, limits, radius);
                Drive::Linear(Box::new(driver.map_err(|e| e.within("follow.driver"))?))
            }
            Interpolation::Arc => {
                let driver = ArcDriver::new(follow, limits)?;
                Drive::Arc(Box::new(driver))
            }
        })
    }

    /// Makes goals for a new map, and for a new part of it.
    fn lay_out(&mut self, map: &PlannerMap, here: Point2<f64>, is_new_part: bool) {
        let is_new_map = self.revision != Some(map.revision());
        if !is_new_map && !is_new_part {
            return;
        }
        let first = self.revision.is_none();
        self.revision = Some(map.revision());
        let made = site(map, self.radius, &self.follow, here).and_then(|site| {
            let (team, own) = self.team.places();
            let site = if self.follow.divide && team.len() > 1 {
                site.divided(&team, own)?
            } else {
                site
            };
            if !first {
                // The current sub-goal belongs to the old workplace.
                self.drive = Self::driver(&self.follow, self.limits, self.radius)?;
            }
            if is_new_map {
                report(&site);
            }
            D::goals(&self.params, &site, self.seed, self.goals.take())
        });
        match made {
            Ok(goals) => {
                self.goals = Some(goals);
                self.last = None;
            }
            Err(reason) => {
                let reason = format!("coverage: {reason}");
                self.failure = Some(ProcessError::Algorithm(reason));
            }
        }
    }
}

impl<D: Design> Planner for Follower<D> {
    const NAME: &'static str = D::NAME;
    const SUMMARY: &'static str = D::SUMMARY;

    type Params = D::Params;

    /// It uses a scan if there is one, but does not need it.
    fn declare(params: &D::Params) -> Declaration {
        let is_linear = D::follow(params).interpolation == Interpolation::Linear;
        Declaration::default()
            .reads(Input::SHAPES)
            .reads_if(is_linear, Input::SCANS.optional())
            .writes(Output::waypoints(64))
    }

    /// Its rectangles are those of the free space; none for a map that it refuses.
    fn sketch(params: &D::Params, robot: &RobotSpec, map: &MapSpec) -> TaskSketch {
        let (follow, start) = (D::follow(params), robot.start.position());
        let radius = robot.model().radius;
        let site = WorldMap::recent(map).ok().and_then(|map| {
            let bounds = *map.bounds();
            Site::new(bounds, map.parts(), radius, &follow, start).ok()
        });
        let rectangles = site.as_ref().map(|site| site.decomposition.rectangles());
        let corners = |r: &Aabb| [r.min, r.max].map(|corner| [corner.x, corner.y]);
        TaskSketch {
            rectangles: rectangles.unwrap_or_default().iter().map(corners).collect(),
            ..TaskSketch::default()
        }
    }

    fn check_task(params: &D::Params, task: &Task<'_>, seed: u64) -> Result<(), TaskFault> {
        check_task::<D>(params, task, seed)
    }

    fn new(params: &D::Params, robot: &RobotInfo, seed: u64) -> Result<Self, PlannerError> {
        parameters::check(params)?;
        let mut follow = D::follow(params);
        let model = &robot.model;
        follow.driver = follow
            .driver
            .for_drive(model.acceleration, model.angular_acceleration);
        let (limits, radius) = (limits(robot)?, robot.model.radius);
        Ok(Self {
            params: params.clone(),
            follow,
            limits,
            radius,
            seed,
            drive: Self::driver(&follow, limits, radius).map_err(PlannerError::algorithm)?,
            goals: None,
            revision: None,
            team: Team::default(),
            last: None,
            before: None,
            reports: Vec::new(),
            failure: None,
        })
    }

    fn open(&mut self, config: &ProcessConfig, _: &Bus, robot: u32) -> Result<(), ProcessError> {
        self.team = Team::new(&config.run.robots, robot);
        Ok(())
    }

    fn failure(&mut self) -> Option<ProcessError> {
        self.failure.take()
    }

    fn prepare(&mut self, map: &PlannerMap, robot: &RobotInfo) {
        self.lay_out(map, robot.start.position(), false);
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.reports.clear();
        let Some(me) = view.robots.get(view.me).filter(|me| me.is_sane()) else {
            return Steering::stop();
        };
        let Pose2 { x, y, .. } = me.pose;
        let here = Point2::new(x, y);
        let is_new_part = self.team.observe(view) && self.follow.divide;
        self.lay_out(map, here, is_new_part);
        let Some(goals) = &mut self.goals else {
            return Steering::stop();
        };
        goals.driven(self.before.replace(here).unwrap_or(here), here);
        let situation = Situation {
            pose: me.pose,
            twist: me.twist,
            scan: view.scan,
            known: map.space().map(AsRef::as_ref),
            time_s: view.time_s,
            dt: view.dt,
        };
        let last = &mut self.last;
        let mut next = || -> Option<Goal> {
            let goal = goals.next_goal(last.unwrap_or(here))?;
            *last = Some(goal.waypoint.point);
            Some(goal)
        };
        let (driving, aim) = match &mut self.drive {
            Drive::Linear(driver) => {
                let mut next = || next().map(|goal| goal.waypoint);
                let driving = driver.drive(&mut next, &situation, &mut self.reports);
                (driving, driver.current().map(|waypoint| waypoint.point))
            }
            Drive::Arc(driver) => {
                let driving = driver.drive(&mut next, &situation, &mut self.reports);
                (driving, driver.current().map(|goal| goal.waypoint.point))
            }
        };
        let DriverOutput {
            command, towards, ..
        } = driving;
        Steering {
            command,
            aim,
            waypoint: towards,
            ..Steering::stop()
        }
    }

    fn waypoints(&mut self) -> &[WaypointReport] {
        &self.reports
    }
}

/// Returns the workplace of a robot: the arena of its map.
fn site(
    map: &PlannerMap,
    radius: f64,
    follow: &FollowParams,
    here: Point2<f64>,
) -> Result<Site, DesignError> {
    let space = map.space().ok_or(DesignError::Shapes)?;
    let (bounds, parts) = (*space.bounds(), space.shapes().parts());
    Ok(Site::new(bounds, parts, radius, follow, here)?)
}

/// Logs the parts of a workplace that will not be covered.
fn report(site: &Site) {
    let decomposition = &site.decomposition;
    let loss = site.workplace.loss();
    if loss.area > 0.0 {
        tracing::info!(
            "obstacles as {} rectangles: {:.3} m² of free space lost ({:.2} %)",
            site.workplace.rectangles().len(),
            loss.area,
            100.0 * loss.share,
        );
    }
    let Some(start) = decomposition.rectangle_at(site.start) else {
        return;
    };
    let unreachable = decomposition.unreachable_from(start);
    if unreachable.components > 0 {
        tracing::warn!(
            "{} part(s) of the workplace cannot be reached from ({:.2}, {:.2}): {:.3} m² of {:.3} m² \
             will not be covered",
            unreachable.components,
            site.start.x,
            site.start.y,
            unreachable.area,
            decomposition.area(),
        );
    }
}
