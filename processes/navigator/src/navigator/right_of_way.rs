//! Right of way among robots that block each other where none can drive around the others.
//!
//! Robots that stand before each other, and all others near them, pass by a common [`Schedule`]. Every
//! navigator computes it from the same positions and goals and follows the progress of all robots, so
//! that they agree without messages. If the robots of a schedule come to stand, for whatever reason, it
//! ends, and the next one begins: all see the same positions then.

use nalgebra::Point2;
use passing::{Schedule, Traveller};
use planner_view::free_space::FreeSpace;
use planner_view::view::{RobotView, View};
use robot::team::Role;
use runtime::config::RobotInfo;

use crate::traffic::{Traffic, spacing};

/// Standstill of two robots before each other after which they block each other (s).
const BLOCKED_S: f64 = 1.5;
/// The same where they cannot pass side by side (s).
const NARROW_S: f64 = 0.1;
/// Standstill of all robots of a schedule after which it ends (s).
const ENDED_S: f64 = 3.0;
/// Time between two attempts (s).
const RETRY_S: f64 = 5.0;
/// Distance up to which robots near each other pass together (m).
const NEAR: f64 = 1.5;

/// Robots that pass each other.
#[derive(Debug, Clone)]
struct Meeting {
    /// Their indices.
    robots: Vec<usize>,
    /// Time of its start (s).
    since: f64,
    schedule: Schedule,
}

/// Right of way of all robots, the same in every navigator.
#[derive(Debug, Clone, Default)]
pub struct RightOfWay {
    robots: Vec<RobotInfo>,
    /// Distance that plans keep from obstacles beyond the radius (m).
    margin: f64,
    meetings: Vec<Meeting>,
    /// Earliest time of the next meeting (s).
    not_before: f64,
}

impl RightOfWay {
    pub(super) fn new(robots: &[RobotInfo], margin: f64) -> Self {
        Self {
            robots: robots.to_vec(),
            margin,
            ..Self::default()
        }
    }

    /// Returns the place (m) to which a robot at `at` (m) drives before it goes on to its goal.
    pub(super) fn destination(
        &self,
        robot: usize,
        at: Point2<f64>,
        space: &FreeSpace,
    ) -> Option<Point2<f64>> {
        self.meetings.iter().find_map(|meeting| {
            let i = meeting.robots.iter().position(|&other| other == robot)?;
            meeting.schedule.destination(i, at, space)
        })
    }

    /// Follows the robots of each meeting, and finds those that block each other.
    pub(super) fn update(&mut self, space: &FreeSpace, view: &View<'_>, traffic: &Traffic) {
        let stands = |robot: usize, least: f64| traffic.stood(robot, view.time_s) >= least;
        self.meetings.retain_mut(|meeting| {
            let at = |&robot: &usize| {
                let active = view.robot(robot).filter(|robot| robot.active);
                active.map(|robot| robot.pose.position())
            };
            let positions: Vec<_> = meeting.robots.iter().map(at).collect();
            meeting.schedule.update(&positions);
            let mut robots = meeting.robots.iter().enumerate();
            let is_new = view.time_s - meeting.since < ENDED_S;
            is_new
                || !robots.all(|(i, &robot)| meeting.schedule.is_done(i) || stands(robot, ENDED_S))
        });
        if view.time_s < self.not_before {
            return;
        }
        let takes_part = |robot: &&RobotView| {
            let has_goal = |info: &RobotInfo| info.goal.is_some();
            let drives = self.robots.get(robot.index).is_some_and(has_goal);
            robot.active && (drives || robot.team.role == Role::Neutral)
        };
        let all: Vec<&RobotView> = view.bodies().filter(takes_part).collect();
        let is_free = |robot: &&&RobotView| {
            let passes = |meeting: &Meeting| meeting.robots.contains(&robot.index);
            let side = robot.radius + self.margin + 2.0 * robot.radius;
            let is_narrow = space.distance(robot.pose.position()) < side;
            stands(robot.index, if is_narrow { NARROW_S } else { BLOCKED_S })
                && !self.meetings.iter().any(passes)
        };
        let stand: Vec<&RobotView> = all.iter().filter(is_free).copied().collect();
        let first = stand.iter().find(|a| {
            let is_before = |b: &&RobotView| {
                let touch = a.radius + b.radius;
                b.index != a.index && distance(a, b) < 2.0 * touch
            };
            stand.iter().any(is_before)
        });
        if let Some(first) = first {
            self.not_before = view.time_s + RETRY_S;
            let group = near(first, &all);
            // A robot that already passes others leaves them.
            self.meetings.retain(|meeting| {
                !group
                    .iter()
                    .any(|robot| meeting.robots.contains(&robot.index))
            });
            self.meetings.extend(self.meet(space, view, &group));
        }
    }

    /// Returns the meeting of these robots; `None` if none of them can reach its goal.
    fn meet(&self, space: &FreeSpace, view: &View<'_>, group: &[&RobotView]) -> Option<Meeting> {
        let robots: Vec<usize> = group.iter().map(|robot| robot.index).collect();
        let models = robots
            .iter()
            .filter_map(|&robot| Some(&self.robots.get(robot)?.model));
        let spacing = spacing(models, self.margin, view.dt);
        let traveller = |robot: &&RobotView| Traveller {
            at: robot.pose.position(),
            forward: robot.pose.forward(),
            goal: self
                .robots
                .get(robot.index)
                .and_then(|info| Some(info.goal?.center())),
        };
        let travellers: Vec<_> = group.iter().map(traveller).collect();
        let others = view.bodies().filter(|robot| !robots.contains(&robot.index));
        let blocked: Vec<_> = others
            .filter(|robot| !robot.active)
            .map(|robot| robot.pose.position())
            .collect();
        let schedule = Schedule::new(space, spacing, &travellers, &blocked)?;
        Some(Meeting {
            robots,
            since: view.time_s,
            schedule,
        })
    }
}

/// Returns the robots that are near this one, or near one of those, in their order.
fn near<'a>(first: &'a RobotView, all: &[&'a RobotView]) -> Vec<&'a RobotView> {
    let mut group = vec![first];
    let mut i = 0;
    while let Some(&robot) = group.get(i) {
        let is_new = |other: &&&RobotView| {
            distance(robot, other) < NEAR && !group.iter().any(|known| known.index == other.index)
        };
        let new: Vec<_> = all.iter().filter(is_new).copied().collect();
        group.extend(new);
        i += 1;
    }
    group.sort_by_key(|robot| robot.index);
    group
}

fn distance(a: &RobotView, b: &RobotView) -> f64 {
    (a.pose.position() - b.pose.position()).norm()
}
