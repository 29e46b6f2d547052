//! Minimum-time planning as a service: `optimiser/plan`.

use iceoryx2::prelude::ZeroCopySend;

use crate::message;
use crate::stamp::{Stamp, headers};

message! {
    /// Header of a planning request; the elements are the obstacles.
    pub struct PlanRequest = "protean/PlanRequest" {
        stamp: Stamp = "when, in which order, by whom",
        start_x: f64 = "start, x [m]",
        start_y: f64 = "start, y [m]",
        start_theta: f64 = "heading at the start [rad]",
        start_v: f64 = "forward speed at the start [m/s]",
        start_omega: f64 = "turning rate at the start [rad/s]",
        goal_x: f64 = "goal, x [m]",
        goal_y: f64 = "goal, y [m]",
        goal_theta: f64 = "heading at the goal [rad]; not a number if free",
        goal_v: f64 = "forward speed at the goal [m/s]; not a number if free",
        v_max: f64 = "largest forward speed [m/s]",
        omega_max: f64 = "largest turning rate [rad/s]",
        acceleration_max: f64 = "largest linear acceleration [m/s^2]; infinite if unlimited",
        angular_acceleration_max: f64 = "largest angular acceleration [rad/s^2]; infinite if unlimited",
        wheel_speed_max: f64 = "largest wheel speed [m/s]; infinite if unlimited",
        wheel_separation: f64 = "distance between the wheels [m]",
        clearance: f64 = "robot radius plus margin that every obstacle is kept away by [m]",
        bounds: [f64; 4] = "x min, y min, x max, y max of the workspace [m]",
        deadline_ns: u64 = "time allowed for the answer [ns]",
        robot: u32 = "index of the robot that will drive",
        method: u32 = "0 bspline, 1 local pursuit, 2 motion camouflage, 3 tangent graph",
    }
}

message! {
    /// One obstacle of a planning request.
    pub struct RequestObstacle = "protean/RequestObstacle" {
        x: f64 = "centre, x [m]",
        y: f64 = "centre, y [m]",
        theta: f64 = "rotation of a rectangle [rad]",
        half_x: f64 = "radius of a circle or half extent along the own x axis [m]",
        half_y: f64 = "0 for a circle, or half extent along the own y axis [m]",
    }
}

message! {
    /// Header of a planning answer; the elements are the samples of the trajectory.
    pub struct PlanResponse = "protean/PlanResponse" {
        stamp: Stamp = "when, in which order, by whom",
        final_time: f64 = "duration of the trajectory [s]",
        lower_bound: f64 = "proven lower bound of the duration [s]",
        min_clearance: f64 = "smallest distance of the path to an inflated obstacle [m]",
        solve_ns: u64 = "time spent on the answer [ns]",
        robot: u32 = "index of the robot that asked",
        method: u32 = "method that made the plan",
        iterations: u32 = "iterations of the outer loop",
        status: u32 = "0 planned, 1 fallback, 2 no path, 3 invalid request, 4 cancelled, 5 deadline",
    }
}

message! {
    /// One sample of a trajectory.
    pub struct TrajectorySample = "protean/TrajectorySample" {
        time_s: f64 = "time from the start [s]",
        x: f64 = "x [m]",
        y: f64 = "y [m]",
        theta: f64 = "heading [rad]",
        v: f64 = "forward speed [m/s]",
        omega: f64 = "turning rate [rad/s]",
    }
}

headers!(PlanRequest, PlanResponse);
