//! Minimum-time planning as a service: `optimiser/plan`.

use crate::message::ZeroCopySend;

use crate::headers;
use crate::message;
use crate::stamp::Stamp;

message! {
    /// Header of a planning request; the elements are the points of the obstacles, encoded as those
    /// of `world/shapes`: one point with a radius is a disc, several are the corners of a convex
    /// polygon. 0 selects the optimiser's own choice where documented.
    pub struct PlanRequest = "protean/PlanRequest" {
        stamp: Stamp = "when, in which order, by whom",
        start_x: f64 = "start, x [m]",
        start_y: f64 = "start, y [m]",
        start_theta: f64 = "heading at the start [rad]",
        start_v: f64 = "forward speed at the start, negative backwards [m/s]; not a number if free",
        start_omega: f64 = "turning rate at the start [rad/s]; not a number if free",
        goal_x: f64 = "goal, x [m]",
        goal_y: f64 = "goal, y [m]",
        goal_theta: f64 = "heading at the goal [rad]; not a number if free",
        goal_v: f64 = "forward speed at the goal, negative backwards [m/s]; not a number if free",
        v_max: f64 = "largest forward speed [m/s]",
        v_min: f64 = "smallest forward speed, negative backwards [m/s]; 0 if plans only drive forwards",
        omega_max: f64 = "largest turning rate [rad/s]",
        acceleration_max: f64 = "largest linear acceleration [m/s^2]; infinite if unlimited",
        angular_acceleration_max: f64 = "largest angular acceleration [rad/s^2]; infinite if unlimited",
        wheel_speed_max: f64 = "largest wheel speed [m/s]; infinite if unlimited",
        wheel_separation: f64 = "distance between the wheels [m]",
        clearance: f64 = "robot radius plus margin that every obstacle is kept away by [m]",
        start_tolerance: f64 = "how deep the start may lie in a grown obstacle [m]; not a number for the optimiser's choice",
        bounds: [f64; 4] = "x min, y min, x max, y max of where the robot's centre may be [m]",
        reference_x: f64 = "reference point of motion camouflage, x [m]; not a number for the optimiser's choice",
        reference_y: f64 = "reference point of motion camouflage, y [m]; not a number for the optimiser's choice",
        deadline_ns: u64 = "time allowed for the answer, from its sending on [ns]; 0 if it does not count: the answer then depends on the request, and on the plan it names in `last`, alone",
        last: u64 = "1 + sequence of this client's request whose plan the robot follows, to begin near that plan; 0 for none",
        robot: u32 = "index of the robot that will drive; a newer request of the same robot cancels this one",
        method: u32 = "0 bspline, 1 local pursuit, 2 motion camouflage, 3 tangent graph",
        guess: u32 = "path that it starts from: 0 exact shortest path, 1 wavefront on a grid",
        degree: u32 = "degree of the B-spline; 0 for the optimiser's choice",
        control_points: u32 = "control points of the B-spline; 0 for the optimiser's choice",
        nodes: u32 = "N of the N + 1 nodes of motion camouflage; 0 for the optimiser's choice",
        shapes: u32 = "number of obstacles that the points make",
        flags: u32 = "sum of 1: nothing but the curve asked for, 2: no search in the controls of a robot with inertia, 4: obstacles are looked at in the nodes only",
    }
}

impl PlanRequest {
    /// [`PlanRequest::method`]: the path is a B-spline.
    pub const BSPLINE: u32 = 0;
    /// [`PlanRequest::method`]: the path pursues a prey.
    pub const LOCAL_PURSUIT: u32 = 1;
    /// [`PlanRequest::method`]: the path hides in front of a prey.
    pub const MOTION_CAMOUFLAGE: u32 = 2;
    /// [`PlanRequest::method`]: the exact shortest path.
    pub const TANGENT: u32 = 3;
    /// [`PlanRequest::guess`]: the exact shortest path.
    pub const GUESS_TANGENT: u32 = 0;
    /// [`PlanRequest::guess`]: the wavefront on a grid, pulled taut.
    pub const GUESS_WAVEFRONT: u32 = 1;
    /// [`PlanRequest::flags`]: only the requested curve is tried.
    pub const NO_FALLBACKS: u32 = 1;
    /// [`PlanRequest::flags`]: no search in the controls of a robot with inertia.
    pub const NO_REFINEMENT: u32 = 2;
    /// [`PlanRequest::flags`]: obstacles are tested only at the nodes, as in the paper.
    pub const AT_NODES: u32 = 4;
    /// Maximum number of obstacles of a request.
    pub const MAX_SHAPES: usize = 1 << 12;
    /// Maximum number of points of a request.
    pub const MAX_POINTS: usize = 1 << 14;
}

/// Length of [`PlanResponse::reason`].
pub const REASON_BYTES: usize = 240;

message! {
    /// Header of a planning answer; the elements are the samples of the trajectory, none without a
    /// plan.
    pub struct PlanResponse = "protean/PlanResponse" {
        stamp: Stamp = "tick and time of the request, by whom answered",
        final_time: f64 = "duration of the trajectory [s]",
        lower_bound: f64 = "proven lower bound of the duration [s]",
        length: f64 = "length of the path [m]",
        min_clearance: f64 = "smallest distance of the path to an inflated obstacle [m]; infinite without obstacles",
        solve_ns: u64 = "time spent on the answer [ns]; 0 on a bus that has no clock",
        robot: u32 = "index of the robot that asked",
        method: u32 = "method that made the plan; as in the request",
        iterations: u32 = "iterations of the outer loop",
        control_points: u32 = "degrees of freedom of the curve; 0 for one without",
        status: u32 = "0 planned, 1 fallback, 2 as far as the deadline allowed; without a plan: 3 invalid request, 4 no path, 5 infeasible, 6 cancelled, 7 out of time, 8 failed; 9 a curve of the method: every search in the controls near it failed",
        failed_searches: u32 = "number of searches in the controls that failed",
        reason: [u8; REASON_BYTES] = "why there is no plan: UTF-8, zeros behind",
    }
}

impl PlanResponse {
    /// A plan by the requested method.
    pub const PLANNED: u32 = 0;
    /// A plan by the exact shortest path, because the method found no valid one.
    pub const FALLBACK: u32 = 1;
    /// A plan by the requested method: a curve, since no search in the controls succeeded near it.
    pub const CURVE: u32 = 9;
    /// The best plan within the time.
    pub const DEADLINE: u32 = 2;
    /// No plan: the request is invalid.
    pub const INVALID: u32 = 3;
    /// No plan: no path leads to the goal.
    pub const NO_PATH: u32 = 4;
    /// No plan: no path allows the prescribed speeds.
    pub const INFEASIBLE: u32 = 5;
    /// No plan: a newer request of the same robot arrived.
    pub const CANCELLED: u32 = 6;
    /// No plan: the time ended before there was any.
    pub const OUT_OF_TIME: u32 = 7;
    /// No plan: the optimiser failed, which is a bug in it.
    pub const FAILED: u32 = 8;
    /// Maximum number of samples of an answer.
    pub const MAX_SAMPLES: usize = 1 << 15;

    /// Returns `true` if the answer is a plan.
    pub fn is_plan(&self) -> bool {
        self.status <= Self::DEADLINE || self.status == Self::CURVE
    }

    /// Converts a text to [`PlanResponse::reason`], cut to its length.
    pub fn reason_of(text: &str) -> [u8; REASON_BYTES] {
        let mut reason = [0; REASON_BYTES];
        // Whole characters only.
        let end = text.char_indices().map(|(at, c)| at + c.len_utf8());
        let end = end.take_while(|&end| end <= REASON_BYTES).last();
        for (byte, &from) in reason
            .iter_mut()
            .zip(text.as_bytes())
            .take(end.unwrap_or(0))
        {
            *byte = from;
        }
        reason
    }

    /// [`PlanResponse::reason`] as text; invalid UTF-8 is replaced.
    pub fn reason_text(&self) -> String {
        let end = self.reason.iter().position(|&b| b == 0);
        let bytes = &self.reason[..end.unwrap_or(REASON_BYTES)];
        String::from_utf8_lossy(bytes).into_owned()
    }
}

message! {
    /// One sample of a trajectory; speeds change linearly in time between two of them, two of the
    /// same time are a step of the speeds.
    pub struct TrajectorySample = "protean/TrajectorySample" {
        time_s: f64 = "time from the start [s]",
        x: f64 = "x [m]",
        y: f64 = "y [m]",
        theta: f64 = "heading, continuous along the trajectory [rad]",
        v: f64 = "forward speed, negative backwards [m/s]",
        omega: f64 = "turning rate [rad/s]",
    }
}

headers!(PlanRequest, PlanResponse);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_is_cut_to_its_length() {
        let text = |reason: &str| {
            PlanResponse {
                reason: PlanResponse::reason_of(reason),
                ..PlanResponse::default()
            }
            .reason_text()
        };
        assert_eq!(text("goal in a wall"), "goal in a wall");
        assert_eq!(text(""), "");
        let long = "ü".repeat(REASON_BYTES);
        assert_eq!(text(&long), "ü".repeat(REASON_BYTES / 2));
        let odd = format!("x{long}");
        assert_eq!(text(&odd).len(), REASON_BYTES - 1);
    }
}
