//! Robots of a team on one contour, at equal distances on the clock of its waypoints.
//!
//! Each robot computes the same from the positions of all: its team needs no messages of its own.
//!
//! - A round of the clock ([`Awg::round_s`]) is divided evenly among the robots that take part. Each has a
//!   *place*: the position of an unprotected patrol on its part of the clock.
//! - The clock stands while a robot that takes part is *away* from its place, by more than a quarter of the
//!   distance between two of them; a robot that is early then waits. Robots gather at their first places in this way,
//!   and late ones get back to theirs. It waits for a round at most.
//! - A robot out of play, or one that is away and counts as [lost](Stay), takes part no more. One that drives on
//!   takes part again, at the place nearest to it.
//! - With each such change the places are divided again. Their order remains, and no place moves back.
//! - Waypoints that a robot covers that stands and does not take part are left out.

use planner_view::stay::Stay;
use planner_view::view::{RobotView, View};
use planner_view::waypoint::{Waypoint, WaypointReport};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::awg::Awg;

/// Distance from its place at which a robot is away, as a share of the distance between two places.
const AWAY: f64 = 0.25;

/// Place at which a patrol begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// The robots of a team that patrol the contour begin at equal distances, the first of them at its first waypoint, as a
    /// single robot does.
    #[default]
    Spread,
    /// Each robot begins where the contour is nearest to it; those of a team spread from there.
    Nearest,
    /// Each robot begins at this waypoint of the contour, from 0, without regard to its team.
    #[serde(untagged)]
    Waypoint(usize),
}

impl Start {
    /// Returns `true` if this many robots keep distances.
    pub fn spreads(self, robots: usize) -> bool {
        robots > 1 && !matches!(self, Self::Waypoint(_))
    }
}

/// A robot of the team.
#[derive(Debug, Clone, Copy)]
struct Member {
    /// Time of a round at its place (s).
    clock_s: f64,
    takes_part: bool,
    is_away: bool,
    stay: Stay,
}

/// The robots of a team on one contour, as one of them sees them.
#[derive(Debug, Clone)]
pub struct Team {
    start: Start,
    /// Width of the zig-zag that the scenario gives (m).
    alpha: Option<f64>,
    /// Indices of the robots, in order.
    robots: Vec<usize>,
    members: Vec<Member>,
    last_s: f64,
    /// `true` if the round has not been divided yet.
    is_uneven: bool,
    waits: bool,
    waited_s: f64,
    /// Due time of the last waypoint that ended for the planner's own robot (s).
    ended_s: f64,
}

impl Team {
    /// The robots with these indices; `None` if they do not spread. `alpha` is the width of the zig-zag if the
    /// scenario gives it (m).
    pub fn new(robots: &[u32], start: Start, alpha: Option<f64>) -> Option<Self> {
        start.spreads(robots.len()).then(|| Self {
            start,
            alpha,
            robots: robots.iter().map(|&robot| robot as usize).collect(),
            members: Vec::new(),
            last_s: 0.0,
            is_uneven: false,
            waits: false,
            waited_s: 0.0,
            ended_s: 0.0,
        })
    }

    /// Follows the robots in a tick: the first one places them.
    pub fn observe(&mut self, awg: &Awg, view: &View<'_>) {
        let robots = core::mem::take(&mut self.robots);
        let seen = |&robot: &usize| view.robot(robot).filter(|robot| robot.active);
        let mut changed = false;
        let elapsed_s = (view.time_s - core::mem::replace(&mut self.last_s, view.time_s)).max(0.0);
        if self.members.is_empty() {
            // One that joins later finds the others near their places.
            let is_spread = self.start == Start::Spread && view.time_s <= 0.0;
            let part_s = awg.round_s() / robots.len() as f64;
            let place = |(number, robot): (usize, Option<&RobotView>)| Member {
                clock_s: match robot {
                    Some(robot) if !is_spread => nearest_s(awg, robot),
                    _ => part_s * number as f64,
                },
                takes_part: robot.is_some(),
                is_away: false,
                stay: Stay::default(),
            };
            self.members = robots.iter().map(seen).enumerate().map(place).collect();
            // Robots that begin where they stand drive to other places along the contour.
            self.is_uneven = !is_spread;
            changed = is_spread && self.taking_part() < robots.len();
        } else if core::mem::take(&mut self.is_uneven) {
            changed = true;
        } else if !self.waits {
            for member in &mut self.members {
                member.clock_s = (member.clock_s + elapsed_s).rem_euclid(awg.round_s());
            }
        }
        let limit = self.away_m(awg);
        for (member, robot) in self.members.iter_mut().zip(robots.iter().map(seen)) {
            changed |= member.follow(awg, robot, view.time_s, limit);
        }
        if changed {
            self.spread(awg);
            self.waited_s = 0.0;
        }
        let limit = self.away_m(awg);
        for (member, robot) in self.members.iter_mut().zip(robots.iter().map(seen)) {
            member.is_away = robot.is_some_and(|robot| member.is_beyond(awg, robot, limit));
        }
        let is_away = self.members.iter().any(|m| m.takes_part && m.is_away);
        self.waited_s = if is_away {
            self.waited_s + elapsed_s
        } else {
            0.0
        };
        self.waits = is_away && self.waited_s < awg.round_s();
        self.robots = robots;
    }

    /// The time of the clock of the planner's own robot (s), not less than the due time of its last waypoint by
    /// more than half of the time between two robots; 0 for one that is not of the team.
    pub fn clock_s(&self, awg: &Awg, own: usize) -> f64 {
        let part_s = awg.round_s() / self.taking_part().max(1) as f64;
        let least = self.ended_s - 0.5 * part_s;
        let clock_s = self.member(own).map_or(0.0, |member| member.clock_s);
        least + (clock_s - least).rem_euclid(awg.round_s())
    }

    /// Returns the time of the clock at which the planner's own robot begins (s), after the first tick.
    pub fn begin(&mut self, own: usize) -> f64 {
        self.ended_s = self.member(own).map_or(0.0, |member| member.clock_s);
        self.ended_s
    }

    /// Takes note of the waypoints that ended for the planner's own robot.
    pub fn take_note(&mut self, awg: &Awg, reports: &[WaypointReport]) {
        if let Some(last) = reports.last() {
            self.ended_s = awg.due_s(last.waypoint.number);
        }
    }

    /// Returns `true` if the planner's own robot waits for others: the clock stands, it is not away, and at this speed
    /// (m/s) it reaches its waypoint before that is due.
    pub fn holds(&self, awg: &Awg, own: &RobotView, waypoint: &Waypoint, v: f64) -> bool {
        let rest_s = awg.due_s(waypoint.number) - self.clock_s(awg, own.index);
        let is_early = (waypoint.point - own.pose.position()).norm() < rest_s * v;
        let is_there = self.member(own.index).is_some_and(|m| !m.is_away);
        self.waits && is_there && is_early
    }

    /// Returns `true` if a robot of the view takes part; one that is not of the team does so while it is in play.
    pub fn counts(&self, robot: &RobotView) -> bool {
        let number = self.robots.iter().position(|&index| index == robot.index);
        let member = number.and_then(|number| self.members.get(number));
        member.map_or(robot.active, |member| member.takes_part)
    }

    /// Number of a robot in the team, from 0; 0 for one that is not of the team.
    pub fn number(&self, robot: usize) -> usize {
        let mut robots = self.robots.iter();
        robots.position(|&index| index == robot).unwrap_or(0)
    }

    fn member(&self, robot: usize) -> Option<&Member> {
        self.members.get(self.number(robot))
    }

    /// Number of robots that take part.
    fn taking_part(&self) -> usize {
        self.members.iter().filter(|m| m.takes_part).count()
    }

    /// Distance from its place at which a robot is away (m): never one that its zig-zag explains.
    fn away_m(&self, awg: &Awg) -> f64 {
        let round_m = awg.contour_length() * awg.round_s() / awg.lap_time();
        let between_m = round_m / self.taking_part().max(1) as f64;
        (AWAY * between_m).max(2.0 * self.alpha.unwrap_or(0.0))
    }

    /// Divides the round evenly among the robots that take part, in their order. The one that is farthest ahead of its
    /// new place keeps its old one.
    fn spread(&mut self, awg: &Awg) {
        let mut order: Vec<usize> = (0..self.members.len()).collect();
        order.retain(|&at| self.members[at].takes_part);
        order.sort_by(|&a, &b| self.members[a].clock_s.total_cmp(&self.members[b].clock_s));
        let part_s = awg.round_s() / order.len().max(1) as f64;
        let places = || (0..).map(|number| part_s * f64::from(number));
        let ahead = order.iter().zip(places());
        let first_s = ahead
            .map(|(&at, place)| self.members[at].clock_s - place)
            .fold(0.0, f64::max);
        for (&at, place) in order.iter().zip(places()) {
            self.members[at].clock_s = (first_s + place).rem_euclid(awg.round_s());
        }
    }
}

impl Member {
    /// Follows the robot, `None` if it is out of play; returns `true` if it takes part from now on, or no more.
    fn follow(&mut self, awg: &Awg, robot: Option<&RobotView>, time_s: f64, limit: f64) -> bool {
        let took_part = self.takes_part;
        let Some(robot) = robot else {
            self.stay = Stay::default();
            return core::mem::take(&mut self.takes_part);
        };
        let (here, reach) = (robot.pose.position(), [robot.radius, limit]);
        let is_due = !self.is_beyond(awg, robot, limit);
        self.takes_part = !self.stay.is_lost(here, time_s, reach, is_due);
        if self.takes_part && !took_part {
            self.clock_s = nearest_s(awg, robot);
        }
        self.takes_part != took_part
    }

    fn is_beyond(&self, awg: &Awg, robot: &RobotView, limit: f64) -> bool {
        (robot.pose.position() - awg.nominal_at(self.clock_s)).norm() > limit
    }
}

fn nearest_s(awg: &Awg, robot: &RobotView) -> f64 {
    awg.nearest_s(robot.pose.position(), robot.pose.theta)
}

#[cfg(test)]
mod tests;
