//! A point that a robot shall visit, and what became of it.

use nalgebra::Point2;

/// What a waypoint is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WaypointKind {
    /// A point of the route as it was ordered; never left out.
    Route,
    /// A point put in to make the way hard to predict.
    Inserted,
    /// A sub-goal of a coverage plan.
    SubGoal,
    /// A sub-goal on the way from one part of a workplace to another.
    Transit,
}

/// A point to be visited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint {
    /// Number of the waypoint in the run, from 0; a number left out on the way is never used again.
    pub number: u64,
    /// Lap (patrol) or large loop (coverage) that it belongs to, from 0.
    pub lap: u32,
    /// What it is for.
    pub kind: WaypointKind,
    /// Where it is, world frame (m).
    pub point: Point2<f64>,
}

/// How a waypoint ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WaypointOutcome {
    /// The robot came within its tolerance.
    Reached,
    /// Left out: it lies inside an obstacle that the robot knows.
    InsideObstacle,
    /// Left out: not reached in the time allowed.
    TimedOut,
    /// Left out: no way leads there.
    Unreachable,
}

/// What became of a waypoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaypointReport {
    /// The waypoint.
    pub waypoint: Waypoint,
    /// How it ended.
    pub outcome: WaypointOutcome,
    /// When the robot set out for it, simulated time (s).
    pub started_s: f64,
    /// When it ended (s).
    pub ended_s: f64,
    /// Nearest that the robot's centre came to it (m); infinite if it never set out.
    pub closest: f64,
}
