//! Sensor data of robots and commands of planners.

use crate::message::ZeroCopySend;

use crate::headers;
use crate::message;
use crate::stamp::Stamp;

message! {
    /// Header of `robot/scan`; the elements are the ranges (m), +∞ where nothing was hit,
    /// −∞ where it was too near (REP-117).
    pub struct ScanHeader = "protean/ScanHeader" {
        stamp: Stamp = "when, in which order, by whom",
        angle_min: f64 = "bearing of the first beam in the robot's frame [rad]",
        angle_increment: f64 = "angle between two beams [rad]",
        range_min: f64 = "shortest measurable range [m]",
        range_max: f64 = "longest measurable range [m]",
        robot: u32 = "index of the robot that carries the sensor",
        reserved: u32 = "always 0",
    }
}

message! {
    /// Velocities of a robot until the next command, in `robot/command`.
    pub struct Command = "protean/Command" {
        v: f64 = "forward speed [m/s]",
        omega: f64 = "turning rate [rad/s]",
        robot: u32 = "index of the robot",
        reserved: u32 = "always 0",
    }
}

message! {
    /// Pose and velocity of a robot outside of the simulation, in `robot/pose`.
    pub struct MeasuredPose = "protean/MeasuredPose" {
        x: f64 = "x [m]",
        y: f64 = "y [m]",
        theta: f64 = "heading [rad]",
        v: f64 = "forward speed [m/s]",
        omega: f64 = "turning rate [rad/s]",
        robot: u32 = "index of the robot",
        reserved: u32 = "always 0",
    }
}

message! {
    /// Header of `robot/plan`.
    pub struct PlanHeader = "protean/PlanHeader" {
        stamp: Stamp = "when, in which order, by whom",
        robot: u32 = "index of the robot that follows the plan",
        target: u32 = "index of the robot it is after, or 4294967295",
    }
}

message! {
    /// One point of a plan.
    pub struct PlanPoint = "protean/PlanPoint" {
        time_s: f64 = "planned time from now [s]; 0 where the plan has no timing",
        x: f64 = "x [m]",
        y: f64 = "y [m]",
        theta: f64 = "heading [rad]",
        v: f64 = "forward speed [m/s]; 0 where the plan has no timing",
        omega: f64 = "turning rate [rad/s]; 0 where the plan has no timing",
    }
}

message! {
    /// Header of `robot/tree`.
    pub struct TreeHeader = "protean/TreeHeader" {
        stamp: Stamp = "when, in which order, by whom",
        robot: u32 = "index of the robot that planned with the tree",
        reserved: u32 = "always 0",
    }
}

message! {
    /// One edge of a search tree.
    pub struct TreeEdge = "protean/TreeEdge" {
        from_x: f32 = "parent, x [m]",
        from_y: f32 = "parent, y [m]",
        to_x: f32 = "child, x [m]",
        to_y: f32 = "child, y [m]",
        cost: f32 = "cost from the root to the child, in the planner's unit",
        on_path: u32 = "1 if the edge belongs to the chosen path",
    }
}

message! {
    /// Outcome of a waypoint, in `robot/waypoint`.
    pub struct WaypointEnd = "protean/WaypointEnd" {
        x: f64 = "where it was, x [m]",
        y: f64 = "where it was, y [m]",
        started_s: f64 = "simulated time at which the robot set out for it [s]",
        ended_s: f64 = "simulated time at which it ended [s]",
        closest: f64 = "nearest that the robot's centre came to it [m]; infinite if it never set out",
        number: u64 = "number of the waypoint in the run, from 0",
        robot: u32 = "index of the robot",
        lap: u32 = "lap (patrol) or large loop (coverage), from 0",
        kind: u8 = "0 of the route, 1 put in, 2 sub-goal, 3 sub-goal in transit",
        outcome: u8 = "0 reached, 1 left out: inside an obstacle, 2 left out: not in time, 3 left out: no way there, 4 left out: stuck",
        reserved: [u8; 6] = "always 0",
    }
}

impl WaypointEnd {
    /// Names of the kinds.
    pub const KINDS: [&'static str; 4] = ["route", "inserted", "sub_goal", "transit"];
    /// Names of the outcomes.
    pub const OUTCOMES: [&'static str; 5] = [
        "reached",
        "inside_obstacle",
        "timed_out",
        "unreachable",
        "stuck",
    ];
}

headers!(ScanHeader, PlanHeader, TreeHeader);
