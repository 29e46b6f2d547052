//! A point that a robot visits, and its outcome.

use nalgebra::Point2;

/// Purpose of a waypoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WaypointKind {
    /// A point of the given route; never skipped.
    Route,
    /// A point inserted to make the path hard to predict.
    Inserted,
    /// A sub-goal of a coverage plan.
    SubGoal,
    /// A sub-goal on the path from one part of a workplace to another.
    Transit,
}

/// A point to visit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint {
    /// Number of the waypoint in the run, from 0; the number of a skipped waypoint is never reused.
    pub number: u64,
    /// Lap (patrol) or large loop (coverage) that it belongs to, from 0.
    pub lap: u32,
    /// Purpose.
    pub kind: WaypointKind,
    /// Position, world frame (m).
    pub point: Point2<f64>,
}

/// Outcome of a waypoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WaypointOutcome {
    /// The robot came within its tolerance.
    Reached,
    /// Skipped: it lies inside a known obstacle.
    InsideObstacle,
    /// Skipped: not reached within the time limit.
    TimedOut,
    /// Skipped: no path leads to it, because obstacles enclose it or the robot, or its position is not finite.
    Unreachable,
    /// Skipped: the robot did not get on, and whether a path leads to it is not known.
    Stuck,
}

/// Report of the outcome of a waypoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaypointReport {
    /// The waypoint.
    pub waypoint: Waypoint,
    /// Outcome.
    pub outcome: WaypointOutcome,
    /// Simulated time at which the robot started towards it (s).
    pub started_s: f64,
    /// Simulated time at which it ended (s).
    pub ended_s: f64,
    /// Minimum distance of the robot's centre from it (m); infinite if the robot never started
    /// towards it.
    pub closest: f64,
}
