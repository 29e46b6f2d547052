//! Patrol with additional waypoints: passes the waypoints of the zig-zag to the driver, one by one.

mod params;

use parameters::check;
use std::collections::VecDeque;

use avoidance::waypoint_driver::{Situation, WaypointDriver};
use chaotic_maps::AnySource;
use nalgebra::Vector2;
use patrol::awg::Laps;
use patrol::mission::{Drive, Mission, MissionError};
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::View;
use planner_view::waypoint::{Waypoint, WaypointReport};
use robot::spec::RobotModel;

use crate::PatrolError;
use crate::check::fitted;

pub use params::{Pace, PatrolAwgParams};

/// Waypoints ahead that are shown.
pub const SHOWN: usize = 12;

/// One robot on patrol.
#[derive(Debug, Clone)]
pub struct PatrolAwg {
    mission: Mission,
    pace: Pace,
    /// Simulated time at which the robot left the start of the contour (s).
    set_out_s: Option<f64>,
    obstacles_known: bool,
    laps: Laps<AnySource>,
    /// Planned waypoints that the driver does not have yet.
    ahead: VecDeque<Waypoint>,
    driver: WaypointDriver,
    radius: f64,
    /// `true` if the zig-zag fits the map.
    entered: bool,
    reports: Vec<WaypointReport>,
}

impl PatrolAwg {
    /// Returns a robot that has not set out yet.
    ///
    /// `seed` is its own; it makes the key if none is given.
    ///
    /// # Errors
    /// [`PatrolError`] naming the invalid parameter and its remedy.
    pub fn new(
        params: &PatrolAwgParams,
        model: &RobotModel,
        seed: u64,
    ) -> Result<Self, PatrolError> {
        check(params)?;
        let drive = Drive::of(model)?;
        let go_to = &params.driver.go_to;
        let mission = params.mission.prepare(&drive, go_to, seed)?;
        let source = mission.key.source().map_err(MissionError::Key)?;
        let mut laps = mission.awg.clone().laps(source);
        Ok(Self {
            pace: params.pace,
            set_out_s: None,
            obstacles_known: params.obstacles_known,
            ahead: laps.by_ref().take(SHOWN).collect(),
            laps,
            mission,
            driver: WaypointDriver::new(drive.driver(&params.driver), drive.limits, model.radius)?,
            radius: model.radius,
            entered: false,
            reports: Vec::new(),
        })
    }

    /// Fits the zig-zag to the first map; later changes of the map do not change it.
    pub fn enter(&mut self, map: &PlannerMap) {
        if core::mem::replace(&mut self.entered, true) {
            return;
        }
        let (known, radius) = (self.obstacles_known, self.radius);
        let Some(mission) = fitted(&self.mission, map, known, radius) else {
            return;
        };
        if let Ok(source) = mission.key.source() {
            self.laps = mission.awg.clone().laps(source);
            self.ahead = self.laps.by_ref().take(SHOWN).collect();
            self.mission = mission;
        }
    }

    /// Returns the mission with all choices made.
    pub fn mission(&self) -> &Mission {
        &self.mission
    }

    /// Returns the simulated time at which the robot left the start of the contour (s): a
    /// forecast's time 0.
    pub fn set_out_s(&self) -> Option<f64> {
        self.set_out_s
    }

    /// Returns the current waypoint and those after it, including those inside obstacles.
    pub fn ahead(&self) -> impl Iterator<Item = &Waypoint> {
        let current = self.driver.current().into_iter();
        current.chain(&self.ahead).take(SHOWN)
    }

    /// Returns the waypoints that ended in the last tick.
    pub fn reports(&self) -> &[WaypointReport] {
        &self.reports
    }

    /// Returns the command for this tick; a stop if its pose is not known.
    pub fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.enter(map);
        self.reports.clear();
        let Some(own) = view.own() else {
            return Steering::stop();
        };
        let situation = Situation {
            pose: own.pose,
            twist: own.twist,
            scan: view.scan,
            known: map
                .space()
                .map(AsRef::as_ref)
                .filter(|_| self.obstacles_known),
            time_s: view.time_s,
            dt: view.dt,
        };
        let (ahead, laps) = (&mut self.ahead, &mut self.laps);
        let mut next = || {
            ahead.extend(laps.next());
            ahead.pop_front()
        };
        let (awg, set_out_s) = (&self.mission.awg, &mut self.set_out_s);
        let pace = self.pace;
        let mut due = |waypoint: &Waypoint| {
            if waypoint.number == 0 {
                return None;
            }
            // After the start has ended: a request for more waypoints means that the robot sets out
            // in this tick.
            let set_out_s = *set_out_s.get_or_insert(view.time_s);
            (pace == Pace::Clock).then(|| set_out_s + awg.due_s(waypoint.number))
        };
        let reports = &mut self.reports;
        let driving = self
            .driver
            .drive_on_time(&mut next, &mut due, &situation, reports);
        Steering {
            command: driving.command,
            target: None,
            aim: self.driver.current().map(|waypoint| waypoint.point),
            waypoint: driving.towards,
            field: Vector2::zeros(),
        }
    }
}
