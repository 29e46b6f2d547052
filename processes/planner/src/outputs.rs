//! Outputs of planners: a command and a plan per robot and tick, and occasionally a tree.

use geometry::pose::Twist2;
use ipc_types::bus::Publisher;
use ipc_types::messages::robot::{
    Command, PlanHeader, PlanPoint, TreeEdge, TreeHeader, WaypointEnd,
};
use ipc_types::messages::world::WorldEvent;
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::{Commands, Plan, RobotEvents, Tree, Waypoints};
use nalgebra::Point2;
use planner_view::event::{RobotEvent, RobotEventKind};
use planner_view::steering::Steering;
use planner_view::waypoint::{WaypointKind, WaypointOutcome, WaypointReport};
use runtime::error::ProcessError;

/// Maximum number of points of a plan message; of a longer plan the first ones.
pub const MAX_PLAN_POINTS: usize = 128;

/// A point of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlannedPoint {
    /// Position (m).
    pub at: Point2<f64>,
    /// Heading there (rad).
    pub theta: f64,
    /// Time until the robot is there (s); 0 in a plan without timing.
    pub time_s: f64,
    /// Forward speed there (m/s); 0 in a plan without timing.
    pub v: f64,
}

/// Writes the default plan of a steering result: the point headed for, and the final one.
pub fn headed_for(steering: &Steering, out: &mut Vec<PlannedPoint>) {
    let points = [steering.waypoint, steering.aim];
    out.extend(points.into_iter().flatten().map(|at| PlannedPoint {
        at,
        ..PlannedPoint::default()
    }));
}

/// Publishers for the results of a tick.
pub struct Outputs<'a> {
    pub(crate) commands: &'a Publisher<Commands>,
    pub(crate) plans: &'a Publisher<Plan>,
    pub(crate) trees: Option<&'a Publisher<Tree>>,
    pub(crate) waypoints: Option<&'a Publisher<Waypoints>>,
    pub(crate) events: Option<&'a Publisher<RobotEvents>>,
    pub(crate) stamp: Stamp,
}

impl Outputs<'_> {
    pub(crate) fn send(
        &self,
        robot: u32,
        steering: &Steering,
        planned: &[PlannedPoint],
    ) -> Result<(), ProcessError> {
        let stamp = self.stamp;
        let Twist2 { v, omega } = steering.command;
        let command = Command {
            v,
            omega,
            robot,
            reserved: 0,
        };
        self.commands.send(PlainHeader { stamp }, &[command])?;
        let target = steering
            .target
            .map_or(WorldEvent::NONE, |target| target as u32);
        let mut points = planned.iter().take(MAX_PLAN_POINTS);
        let count = points.len();
        self.plans.send_with(
            PlanHeader {
                stamp,
                robot,
                target,
            },
            count,
            |_| {
                let point = points.next().copied().unwrap_or_default();
                PlanPoint {
                    time_s: point.time_s,
                    x: point.at.x,
                    y: point.at.y,
                    theta: point.theta,
                    v: point.v,
                    ..PlanPoint::default()
                }
            },
        )?;
        Ok(())
    }

    /// Sends the edges of a tree that fit a message.
    pub(crate) fn send_tree(&self, robot: u32, edges: &[TreeEdge]) -> Result<(), ProcessError> {
        let Some(trees) = self.trees else {
            return Ok(());
        };
        let header = TreeHeader {
            stamp: self.stamp,
            robot,
            reserved: 0,
        };
        trees.send(header, edges.get(..trees.capacity()).unwrap_or(edges))?;
        Ok(())
    }

    /// Sends the ended waypoints that fit a message, if there are any.
    pub(crate) fn send_waypoints(
        &self,
        robot: u32,
        ended: &[WaypointReport],
    ) -> Result<(), ProcessError> {
        let Some(waypoints) = self.waypoints.filter(|_| !ended.is_empty()) else {
            return Ok(());
        };
        let mut ended = ended.iter().take(waypoints.capacity());
        waypoints.send_with(
            PlainHeader { stamp: self.stamp },
            ended.len(),
            |_| match ended.next() {
                Some(report) => waypoint_end(robot, report),
                None => WaypointEnd::default(),
            },
        )?;
        Ok(())
    }

    /// Sends the events that fit a message, if there are any.
    pub(crate) fn send_events(
        &self,
        robot: u32,
        events: &[RobotEvent],
    ) -> Result<(), ProcessError> {
        let Some(publisher) = self.events.filter(|_| !events.is_empty()) else {
            return Ok(());
        };
        let mut events = events.iter().take(publisher.capacity());
        publisher.send_with(
            PlainHeader { stamp: self.stamp },
            events.len(),
            |_| match events.next() {
                Some(event) => robot_event(robot, event),
                None => WorldEvent::default(),
            },
        )?;
        Ok(())
    }
}

fn robot_event(robot: u32, event: &RobotEvent) -> WorldEvent {
    WorldEvent {
        x: event.at.x,
        y: event.at.y,
        kind: match event.kind {
            RobotEventKind::Sighted => WorldEvent::SIGHTED,
            RobotEventKind::Lost => WorldEvent::LOST,
            RobotEventKind::Returned => WorldEvent::RETURNED,
        },
        robot,
        other: event.other as u32,
        ..WorldEvent::default()
    }
}

fn waypoint_end(robot: u32, report: &WaypointReport) -> WaypointEnd {
    let waypoint = &report.waypoint;
    WaypointEnd {
        x: waypoint.point.x,
        y: waypoint.point.y,
        started_s: report.started_s,
        ended_s: report.ended_s,
        closest: report.closest,
        number: waypoint.number,
        robot,
        lap: waypoint.lap,
        kind: match waypoint.kind {
            WaypointKind::Route => 0,
            WaypointKind::Inserted => 1,
            WaypointKind::SubGoal => 2,
            WaypointKind::Transit => 3,
        },
        outcome: match report.outcome {
            WaypointOutcome::Reached => 0,
            WaypointOutcome::InsideObstacle => 1,
            WaypointOutcome::TimedOut => 2,
            WaypointOutcome::Unreachable => 3,
            WaypointOutcome::Stuck => 4,
        },
        reserved: [0; 6],
    }
}
