//! The part of a robot on patrol that does not depend on the source of its waypoints: its mission, its team and its driver.

use avoidance::waypoint_driver::{DriverParams, Situation, WaypointDriver};
use geometry::pose::Twist2;
use nalgebra::Vector2;
use patrol::awg::Awg;
use patrol::mission::{Drive, Mission, MissionParams};
use patrol::team::Team;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::{RobotView, ScanView, View};
use planner_view::waypoint::{Waypoint, WaypointReport};
use robot::spec::RobotModel;

use crate::PatrolError;
use crate::check::fitted;

/// One robot on its round.
#[derive(Debug, Clone)]
pub struct Round {
    pub mission: Mission,
    pub team: Option<Team>,
    /// Its highest speed between waypoints (m/s).
    v_max: f64,
    /// Time of a round at which it begins (s), from the first tick on.
    pub start_s: Option<f64>,
    pub obstacles_known: bool,
    pub driver: WaypointDriver,
    pub radius: f64,
    /// `true` if the zig-zag fits the map.
    entered: bool,
    pub reports: Vec<WaypointReport>,
}

impl Round {
    /// Returns a robot that has not set out yet; `seed` is its own and makes the key if none is given.
    ///
    /// # Errors
    /// [`PatrolError`] naming the invalid parameter and its remedy.
    pub fn new(
        mission: &MissionParams,
        driver: &DriverParams,
        obstacles_known: bool,
        drive: &Drive,
        model: &RobotModel,
        seed: u64,
    ) -> Result<Self, PatrolError> {
        Ok(Self {
            mission: mission.prepare(drive, &driver.go_to, seed)?,
            team: None,
            v_max: drive.limits.v_max() * driver.go_to.speed_fraction,
            start_s: None,
            obstacles_known,
            driver: WaypointDriver::new(drive.driver(driver), drive.limits, model.radius)?,
            radius: model.radius,
            entered: false,
            reports: Vec::new(),
        })
    }

    /// Makes it one of the robots with these indices; returns its mission then.
    pub fn join(&mut self, robots: &[u32]) -> Mission {
        self.team = self.mission.team(robots);
        self.mission.clone().of_team(robots.len())
    }

    /// Returns its mission fitted to the first map; `None` for later ones, and without an exact map.
    pub fn enter(&mut self, map: &PlannerMap, obstacles_known: bool) -> Option<Mission> {
        if core::mem::replace(&mut self.entered, true) {
            return None;
        }
        fitted(&self.mission, map, obstacles_known, self.radius)
    }

    /// Returns, in the first tick, its mission and the time of a round at which it begins (s), at its place of the
    /// contour.
    pub fn begin(&mut self, own: &RobotView) -> Option<(Mission, f64)> {
        if self.start_s.is_some() {
            return None;
        }
        let start_s = match &mut self.team {
            Some(team) => team.begin(own.index),
            None => self.mission.start_s(&own.pose),
        };
        self.start_s = Some(start_s);
        let number = self.team.as_ref().map_or(0, |team| team.number(own.index));
        Some((self.mission.clone().of_robot(number), start_s))
    }

    /// Follows the others of the team.
    pub fn observe(&mut self, view: &View<'_>) {
        self.reports.clear();
        if let Some(team) = &mut self.team {
            team.observe(&self.mission.awg, view);
        }
    }

    /// Drives on to the next waypoint. `due` is the due time of a waypoint (simulated time, s) for a robot without a
    /// team; in a team, its clock gives it.
    pub fn drive(
        &mut self,
        map: &PlannerMap,
        view: &View<'_>,
        own: &RobotView,
        scan: Option<ScanView<'_>>,
        mut next: impl FnMut() -> Option<Waypoint>,
        mut due: impl FnMut(&Awg, &Waypoint) -> Option<f64>,
    ) -> Steering {
        let awg = &self.mission.awg;
        let clock_s = self.team.as_ref().map(|team| team.clock_s(awg, own.index));
        let mut due = |waypoint: &Waypoint| match clock_s {
            Some(clock_s) => Some(view.time_s + (awg.due_s(waypoint.number) - clock_s)),
            None => due(awg, waypoint),
        };
        let situation = Situation {
            pose: own.pose,
            twist: own.twist,
            scan,
            known: map
                .space()
                .map(AsRef::as_ref)
                .filter(|_| self.obstacles_known),
            time_s: view.time_s,
            dt: view.dt,
        };
        let reports = &mut self.reports;
        if let Some(team) = &self.team {
            let is_covered = |point| view.is_covered(point, own, |robot| team.counts(robot));
            self.driver.leave_out(is_covered, view.time_s, reports);
        }
        let driving = self
            .driver
            .drive_on_time(&mut next, &mut due, &situation, reports);
        let mut command = driving.command;
        if let (Some(team), Some(waypoint)) = (&mut self.team, self.driver.current()) {
            team.take_note(awg, &self.reports);
            if team.holds(awg, own, waypoint, self.v_max) {
                command = Twist2::STOP;
            }
        }
        Steering {
            command,
            target: None,
            aim: self.driver.current().map(|waypoint| waypoint.point),
            waypoint: driving.towards,
            field: Vector2::zeros(),
        }
    }
}
