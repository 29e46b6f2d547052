//! Patrol with additional waypoints: passes the waypoints of the zig-zag to the driver, one by one.

mod params;

use parameters::check;
use std::collections::VecDeque;

use chaotic_maps::AnySource;
use patrol::awg::{Awg, Laps};
use patrol::mission::{Drive, Mission, MissionError};
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::{RobotView, View};
use planner_view::waypoint::{Waypoint, WaypointOutcome, WaypointReport};
use robot::spec::RobotModel;

use crate::PatrolError;
use crate::round::Round;

pub use params::{Pace, PatrolAwgParams};

/// Waypoints ahead that are shown.
pub const SHOWN: usize = 12;

/// Maximum number of waypoints that end in a tick.
pub(crate) const MAX_REPORTS: usize = 64;

/// One robot on patrol.
#[derive(Debug, Clone)]
pub struct PatrolAwg {
    round: Round,
    pace: Pace,
    /// Number of its first waypoint.
    first: u64,
    /// Simulated time at which the robot left the start of the contour (s).
    set_out_s: Option<f64>,
    laps: Laps<AnySource>,
    /// Planned waypoints that the driver does not have yet.
    ahead: VecDeque<Waypoint>,
    /// `true` while it is off its round.
    is_off: bool,
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
        let (mission, driver) = (&params.mission, &params.driver);
        let round = Round::new(mission, driver, params.obstacles_known, &drive, model, seed)?;
        let source = round.mission.key.source().map_err(MissionError::Key)?;
        let mut laps = round.mission.awg.clone().laps(source);
        Ok(Self {
            pace: params.pace,
            first: 0,
            set_out_s: None,
            ahead: laps.by_ref().take(SHOWN).collect(),
            laps,
            round,
            is_off: false,
        })
    }

    /// Makes it one of the robots with these indices, which have the same task, itself included.
    #[must_use]
    pub fn in_team(mut self, robots: &[u32]) -> Self {
        let mission = self.round.join(robots);
        self.plan(mission, 0.0);
        self
    }

    /// Plans the waypoints of a mission from a time of a round on (s).
    fn plan(&mut self, mission: Mission, start_s: f64) {
        if let Ok(source) = mission.key.source() {
            self.laps = Laps::from_clock(mission.awg.clone(), source, start_s);
            self.ahead = self.laps.by_ref().take(SHOWN).collect();
            self.first = self.ahead.front().map_or(0, |waypoint| waypoint.number);
            self.round.mission = mission;
        }
    }

    /// Fits the zig-zag to the first map; later changes of the map do not change it.
    pub fn enter(&mut self, map: &PlannerMap) {
        if let Some(mission) = self.round.enter(map, self.round.obstacles_known) {
            self.plan(mission, 0.0);
        }
    }

    /// Follows the others of the team in a tick in which the robot is off its round. The next [`Self::steer`] takes the
    /// round up again, where the robot is nearest to it; the waypoints before it are left out.
    pub fn leave(&mut self, view: &View<'_>) {
        self.round.observe(view);
        if !core::mem::replace(&mut self.is_off, true) {
            let Round {
                driver, reports, ..
            } = &mut self.round;
            let onward = driver.abandon(view.time_s, reports);
            if let Some(onward) = onward {
                self.ahead.push_front(onward);
            }
        }
    }

    /// Leaves out waypoints, no more than one message holds, before the place where the robot takes up its round.
    fn rejoin(&mut self, own: &RobotView, time_s: f64) {
        let awg = &self.round.mission.awg;
        let next_s = self
            .ahead
            .front()
            .map_or(0.0, |next| awg.due_s(next.number));
        let clock_s = if let Some(team) = &self.round.team {
            team.clock_s(awg, own.index)
        } else {
            let nearest_s = awg.nearest_s(own.pose.position(), own.pose.theta);
            let clock_s = next_s + (nearest_s - next_s).rem_euclid(awg.round_s());
            self.set_out_s = Some(time_s - (clock_s - self.round.start_s.unwrap_or(0.0)));
            clock_s
        };
        while let Some(next) = self.ahead.front()
            && awg.due_s(next.number) < clock_s
        {
            if self.round.reports.len() == MAX_REPORTS {
                self.is_off = true;
                break;
            }
            self.round.reports.push(WaypointReport {
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
        &self.round.mission
    }

    /// Returns the simulated time at which the robot left the start of the contour (s): a
    /// forecast's time 0.
    pub fn set_out_s(&self) -> Option<f64> {
        self.set_out_s
    }

    /// Returns the current waypoint and those after it, including those inside obstacles.
    pub fn ahead(&self) -> impl Iterator<Item = &Waypoint> {
        let current = self.round.driver.current().into_iter();
        current.chain(&self.ahead).take(SHOWN)
    }

    /// Returns the waypoints that ended in the last tick.
    pub fn reports(&self) -> &[WaypointReport] {
        &self.round.reports
    }

    /// Returns the command for this tick; a stop if its pose is not known.
    pub fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        self.enter(map);
        self.round.observe(view);
        let Some(own) = view.own() else {
            return Steering::stop();
        };
        if core::mem::take(&mut self.is_off) && self.round.start_s.is_some() {
            self.rejoin(own, view.time_s);
        }
        if let Some((mission, start_s)) = self.round.begin(own) {
            self.plan(mission, start_s);
        }
        if self.is_off {
            return Steering::stop();
        }
        let (ahead, laps) = (&mut self.ahead, &mut self.laps);
        let next = || {
            ahead.extend(laps.next());
            ahead.pop_front()
        };
        let (pace, first, set_out_s) = (self.pace, self.first, &mut self.set_out_s);
        let start_s = self.round.start_s.unwrap_or(0.0);
        let due = |awg: &Awg, waypoint: &Waypoint| {
            if waypoint.number == first {
                return None;
            }
            // After the start has ended: a request for more waypoints means that the robot sets out
            // in this tick.
            let set_out_s = *set_out_s.get_or_insert(view.time_s);
            (pace == Pace::Clock).then(|| set_out_s + (awg.due_s(waypoint.number) - start_s))
        };
        self.round.drive(map, view, own, view.scan, next, due)
    }
}
