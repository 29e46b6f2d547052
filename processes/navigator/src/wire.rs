//! Conversion of requests and answers to messages.

use geometry::pose::{Pose2, Twist2};
use ipc_types::messages::optimiser::{PlanRequest, PlanResponse, TrajectorySample};
use ipc_types::messages::world::ShapePoint;
use ipc_types::stamp::Stamp;
use runtime::shapes;
use trajectory_problem::Problem;

use crate::params::PlanningParams;
use crate::plan_failure::PlanFailure;
use crate::trajectory::{Sample, Trajectory};

/// Encodes a request; `last` as in [`PlanRequest::last`], the distance between the wheels (m) also of a robot whose wheels
/// limit nothing.
pub fn encode(
    ask: &Problem,
    params: &PlanningParams,
    wheel_separation: f64,
    robot: u32,
    last: u64,
    deadline_ns: u64,
    stamp: Stamp,
) -> (PlanRequest, Vec<ShapePoint>) {
    let unlimited = |limit: Option<f64>| limit.unwrap_or(f64::INFINITY);
    let free = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let limits = &ask.limits;
    let [reference_x, reference_y] = params.reference_point.unwrap_or([f64::NAN; 2]);
    let header = PlanRequest {
        stamp,
        start_x: ask.start.x,
        start_y: ask.start.y,
        start_theta: ask.start.theta,
        start_v: free(ask.start_speed),
        start_omega: free(ask.start_turn_rate),
        goal_x: ask.goal.x,
        goal_y: ask.goal.y,
        goal_theta: free(ask.goal_heading),
        goal_v: free(ask.goal_speed),
        v_max: limits.v_max,
        v_min: limits.v_min,
        omega_max: limits.omega_max,
        acceleration_max: unlimited(limits.acceleration),
        angular_acceleration_max: unlimited(limits.angular_acceleration),
        wheel_speed_max: unlimited(limits.wheels.map(|wheels| wheels.speed)),
        wheel_separation,
        clearance: ask.clearance,
        start_tolerance: ask.start_tolerance,
        bounds: [
            ask.bounds.min.x,
            ask.bounds.min.y,
            ask.bounds.max.x,
            ask.bounds.max.y,
        ],
        reference_x,
        reference_y,
        deadline_ns,
        last,
        robot,
        method: params.method.code(),
        guess: params.guess.code(),
        degree: params.degree.unwrap_or(0),
        control_points: params.control_points.unwrap_or(0),
        nodes: params.nodes.unwrap_or(0),
        shapes: ask.obstacles.len() as u32,
        flags: 0,
    };
    (header, shapes::points(&ask.obstacles))
}

/// Returns the trajectory of an answer.
///
/// # Errors
/// [`PlanFailure`] states the reason for the lack of one.
pub fn decode(
    header: &PlanResponse,
    samples: &[TrajectorySample],
) -> Result<Trajectory, PlanFailure> {
    let reason = header.reason_text();
    match header.status {
        _ if header.is_plan() => {}
        PlanResponse::NO_PATH => return Err(PlanFailure::NoPath),
        PlanResponse::INFEASIBLE => return Err(PlanFailure::Infeasible(reason)),
        PlanResponse::CANCELLED | PlanResponse::OUT_OF_TIME => {
            return Err(PlanFailure::NoAnswer(reason));
        }
        _ => return Err(PlanFailure::Refused(reason)),
    }
    let samples = samples.iter().map(|sample| Sample {
        t: sample.time_s,
        pose: Pose2 {
            x: sample.x,
            y: sample.y,
            theta: sample.theta,
        },
        twist: Twist2::new(sample.v, sample.omega),
    });
    Trajectory::new(samples.collect()).map_err(|e| PlanFailure::Refused(e.to_string()))
}
