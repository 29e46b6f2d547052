//! Patrol with additional waypoints: passes the waypoints of the zig-zag to the driver, one by one.

mod params;

use parameters::check;
use std::collections::VecDeque;

use avoidance::waypoint_driver::{Situation, WaypointDriver};
use chaotic_maps::AnySource;
use geometry::pose::Twist2;
use nalgebra::Vector2;
use patrol::awg::Laps;
use patrol::mission::{Drive, Mission, MissionError};
use patrol::team::Team;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::{RobotView, View};
use planner_view::waypoint::{Waypoint, WaypointOutcome, WaypointReport};
use robot::spec::RobotModel;

use crate::PatrolError;
use crate::check::fitted;

pub use params::{Pace, PatrolAwgParams};

/// Waypoints ahead that are shown.
pub const SHOWN: usize = 12;

/// Maximum number of waypoints that end in a tick.
pub(crate) const MAX_REPORTS: usize = 64;

/// One robot on patrol.
#[derive(Debug, Clone)]
pub struct PatrolAwg {
    mission: Mission,
    team: Option<Team>,
    pace: Pace,
    /// Its highest speed between waypoints (m/s).
    v_max: f64,
    /// Time of a round at which it begins (s), from the first tick on.
    start_s: Option<f64>,
    /// Number of its first waypoint.
    first: u64,
    /// Simulated time at which the robot left the start of the contour (s).
    set_out_s: Option<f64>,
    obstacles_known: bool,
    laps: Laps<AnySource>,
    /// Planned waypoints that the driver does not have yet.
    ahead: VecDeque<Waypoint>,
    driver: WaypointDriver,
    radius: f64,
    /// `true` while it is off its round.
    is_off: bool,
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
        let drive = Drive::from_model(model)?;
        let go_to = &params.driver.go_to;
        let mission = params.mission.prepare(&drive, go_to, seed)?;
        let source = mission.key.source().map_err(MissionError::Key)?;
        let mut laps = mission.awg.clone().laps(source);
        Ok(Self {
            team: None,
            pace: params.pace,
            v_max: drive.limits.v_max() * go_to.speed_fraction,
            start_s: None,
            first: 0,
            set_out_s: None,
            obstacles_known: params.obstacles_known,
            ahead: laps.by_ref().take(SHOWN).collect(),
            laps,
            mission,
            driver: WaypointDriver::new(drive.driver(&params.driver), drive.limits, model.radius)?,
            radius: model.radius,
            is_off: false,
            entered: false,
            reports: Vec::new(),
        })
    }

    /// Makes it one of the robots with these indices, which have the same task, itself included.
    #[must_use]
    pub fn in_team(mut self, robots: &[u32]) -> Self {
        self.team = self.mission.team(robots);
        let mission = self.mission.clone().of_team(robots.len());
        self.plan(mission, 0.0);
        self
    }

    /// Plans the waypoints of a mission from a time of a round on (s).
    fn plan(&mut self, mission: Mission, start_s: f64) {
        if let Ok(source) = mission.key.source() {
            self.laps = Laps::from_clock(mission.awg.clone(), source, start_s);
            self.ahead = self.laps.by_ref().take(SHOWN).collect();
            self.first = self.ahead.front().map_or(0, |waypoint| waypoint.number);
            self.mission = mission;
        }
    }

    /// Begins in the first tick, at its place of the contour.
    fn begin(&mut self, own: &RobotView) -> f64 {
        if let Some(start_s) = self.start_s {
            return start_s;
        }
        let start_s = match &mut self.team {
            Some(team) => team.begin(own.index),
            None => self.mission.start_s(&own.pose),
        };
        let number = self.team.as_ref().map_or(0, |team| team.number(own.index));
        self.plan(self.mission.clone().of_robot(number), start_s);
        *self.start_s.insert(start_s)
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
        self.plan(mission, 0.0);
    }

    /// Follows the others of the team in a tick in which the robot is off its round. The next [`Self::steer`] takes the
    /// round up again, where the robot is nearest to it; the waypoints before it are left out.
    pub fn leave(&mut self, view: &View<'_>) {
        self.reports.clear();
        if let Some(team) = &mut self.team {
            team.observe(&self.mission.awg, view);
        }
        if !core::mem::replace(&mut self.is_off, true) {
            let onward = self.driver.abandon(view.time_s, &mut self.reports);
            if let Some(onward) = onward {
                self.ahead.push_front(onward);
            }
        }
    }

    /// Leaves out waypoints, no more than one message holds, before the place where the robot takes up its round.
    fn rejoin(&mut self, own: &RobotView, time_s: f64) {
        let awg = &self.mission.awg;
        let next_s = self
            .ahead
            .front()
            .map_or(0.0, |next| awg.due_s(next.number));
        let clock_s = if let Some(team) = &self.team {
            team.clock_s(awg, own.index)
        } else {
            let nearest_s = awg.nearest_s(own.pose.position(), own.pose.theta);
            let clock_s = next_s + (nearest_s - next_s).rem_euclid(awg.round_s());
            self.set_out_s = Some(time_s - (clock_s - self.start_s.unwrap_or(0.0)));
            clock_s
        };
        while let Some(next) = self.ahead.front()
            && awg.due_s(next.number) < clock_s
        {
            if self.reports.len() == MAX_REPORTS {
                self.is_off = true;
                break;
            }
            self.reports.push(WaypointReport {
                waypoint: *next,
                outcome: WaypointOutcome::TimedOut,
                started_s: time_s,
                ended_s: time_s,
                closest: f64::INFINITY,
            });
            self.ahead.pop_front();
            self.ahead.extend(self.laps.next());
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
        if let Some(team) = &mut self.team {
            team.observe(&self.mission.awg, view);
        }
        let Some(own) = view.own() else {
            return Steering::stop();
        };
        if core::mem::take(&mut self.is_off) && self.start_s.is_some() {
            self.rejoin(own, view.time_s);
        }
        let start_s = self.begin(own);
        if self.is_off {
            return Steering::stop();
        }
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
        let (pace, first) = (self.pace, self.first);
        let clock_s = self.team.as_ref().map(|team| team.clock_s(awg, own.index));
        let mut due = |waypoint: &Waypoint| {
            let due_s = awg.due_s(waypoint.number);
            if let Some(clock_s) = clock_s {
                return Some(view.time_s + (due_s - clock_s));
            }
            if waypoint.number == first {
                return None;
            }
            // After the start has ended: a request for more waypoints means that the robot sets out
            // in this tick.
            let set_out_s = *set_out_s.get_or_insert(view.time_s);
            (pace == Pace::Clock).then_some(set_out_s + (due_s - start_s))
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
