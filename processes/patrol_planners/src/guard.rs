//! A guard: patrols with additional waypoints, and pursues the intruders that it sights.

use nalgebra::Point2;
use parameters::check;
use patrol::pursuits::Pursuits;
use planner_view::event::{RobotEvent, RobotEventKind};
use planner_view::limits::Limits;
use planner_view::map::PlannerMap;
use planner_view::steering::Steering;
use planner_view::view::{RobotView, View};
use planner_view::waypoint::WaypointOutcome;
use pursuit_evasion::pursuit::Pursuer;

use crate::pursue::PursueParams;
use crate::{PatrolAwg, PatrolError};

/// The part of a guard that pursues.
#[derive(Debug, Clone)]
struct Pursuit {
    pursuits: Pursuits,
    pursuer: Pursuer,
    /// Its intruder in the last tick.
    intruder: Option<usize>,
    /// The intruder that it has pursued, until it is back on its patrol.
    returns_from: Option<usize>,
    robots: Vec<RobotView>,
    events: Vec<RobotEvent>,
}

/// One robot on patrol; with [`Self::pursuing`] also in pursuit.
#[derive(Debug, Clone)]
pub struct Guard {
    patrol: PatrolAwg,
    pursuit: Option<Pursuit>,
}

impl Guard {
    /// A robot that only patrols.
    pub fn new(patrol: PatrolAwg) -> Self {
        Self {
            patrol,
            pursuit: None,
        }
    }

    /// Makes it one of the guards with these indices that pursue intruders; `seed` is its own.
    ///
    /// # Errors
    /// [`PatrolError::Params`] names the parameter that is out of its range.
    pub fn pursuing(
        mut self,
        params: &PursueParams,
        guards: &[u32],
        limits: Limits,
        seed: u64,
    ) -> Result<Self, PatrolError> {
        check(params)?;
        self.pursuit = Some(Pursuit {
            pursuits: Pursuits::new(guards, params.lost_s),
            pursuer: Pursuer::new(params.tactics, limits, seed)?,
            intruder: None,
            returns_from: None,
            robots: Vec::new(),
            events: Vec::new(),
        });
        Ok(self)
    }

    /// The patrol.
    pub fn patrol(&self) -> &PatrolAwg {
        &self.patrol
    }

    /// Returns `true` if it pursues an intruder in this tick.
    pub fn is_in_pursuit(&self) -> bool {
        self.pursuit.as_ref().is_some_and(|p| p.intruder.is_some())
    }

    /// Events of the last tick.
    pub fn events(&self) -> &[RobotEvent] {
        self.pursuit.as_ref().map_or(&[], |pursuit| &pursuit.events)
    }

    /// Fits the zig-zag to the first map, and computes the paths through every map for a robot of this radius (m).
    pub fn prepare(&mut self, map: &PlannerMap, radius: f64) {
        self.patrol.enter(map);
        if let Some(pursuit) = &mut self.pursuit {
            pursuit.pursuer.prepare(map, radius);
        }
    }

    /// Returns the command for this tick.
    pub fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        let Some(pursuit) = &mut self.pursuit else {
            return self.patrol.steer(map, view);
        };
        pursuit.decide(map, view);
        let mut robots = core::mem::take(&mut pursuit.robots);
        pursuit.pursuits.on_patrol(view.robots, &mut robots);
        let as_seen = View {
            robots: &robots,
            ..*view
        };
        let steering = if pursuit.intruder.is_some() {
            self.patrol.leave(&as_seen);
            pursuit.pursuits.in_pursuit(view.robots, &mut robots);
            let as_seen = View {
                robots: &robots,
                ..*view
            };
            pursuit.pursuer.command(map, &as_seen)
        } else {
            let steering = self.patrol.steer(map, &as_seen);
            let mut ended = self.patrol.reports().iter();
            let reached = ended.find(|end| end.outcome == WaypointOutcome::Reached);
            if let Some(end) = reached
                && let Some(intruder) = pursuit.returns_from.take()
            {
                pursuit.report(RobotEventKind::Returned, intruder, end.waypoint.point);
            }
            steering
        };
        pursuit.robots = robots;
        steering
    }
}

impl Pursuit {
    /// Decides whether the guard pursues an intruder in this tick, and reports a change.
    fn decide(&mut self, map: &PlannerMap, view: &View<'_>) {
        self.events.clear();
        self.pursuits.observe(map, view);
        let before = core::mem::replace(&mut self.intruder, self.pursuits.intruder_of(view.me));
        if before == self.intruder {
            return;
        }
        let place = |robot| view.belief(robot).map(|belief| belief.mean.position());
        if let Some(lost) = before {
            self.returns_from = Some(lost);
            // Of one that is out of play the world reports why.
            if view.robot(lost).is_some_and(|robot| robot.active) {
                let at = place(lost).unwrap_or_default();
                self.report(RobotEventKind::Lost, lost, at);
            }
        }
        if let Some(sighted) = self.intruder {
            self.returns_from = None;
            let at = place(sighted).unwrap_or_default();
            self.report(RobotEventKind::Sighted, sighted, at);
        }
    }

    fn report(&mut self, kind: RobotEventKind, other: usize, at: Point2<f64>) {
        self.events.push(RobotEvent { kind, other, at });
    }
}
