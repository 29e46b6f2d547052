//! Conversion of requests and answers to messages.

use geometry::pose::{Pose2, Twist2};
use ipc_types::messages::optimiser::{PlanRequest, PlanResponse, TrajectorySample};
use ipc_types::messages::world::ShapePoint;
use ipc_types::stamp::Stamp;
use runtime::shapes;

use crate::params::{Guess, Method, PlanningParams};
use crate::trajectory::{Sample, Trajectory};
use crate::trajectory_request::{PlanFailure, TrajectoryRequest};

/// Encodes a request; `last` as in [`PlanRequest::last`].
pub fn encode(
    ask: &TrajectoryRequest,
    params: &PlanningParams,
    robot: u32,
    last: u64,
    deadline_ns: u64,
    stamp: Stamp,
) -> (PlanRequest, Vec<ShapePoint>) {
    let unlimited = |limit: Option<f64>| limit.unwrap_or(f64::INFINITY);
    let free = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let model = &ask.model;
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
        goal_theta: f64::NAN,
        goal_v: free(ask.goal_speed),
        v_max: model.v_max,
        v_min: 0.0 - model.v_reverse_max,
        omega_max: model.omega_max,
        acceleration_max: unlimited(model.acceleration),
        angular_acceleration_max: unlimited(model.angular_acceleration),
        wheel_speed_max: unlimited(model.wheel_speed_max),
        wheel_separation: model.wheel_separation,
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
        method: match params.method {
            Method::Bspline => PlanRequest::BSPLINE,
            Method::Lp => PlanRequest::LOCAL_PURSUIT,
            Method::Vmc => PlanRequest::MOTION_CAMOUFLAGE,
            Method::Tangent => PlanRequest::TANGENT,
        },
        guess: match params.guess {
            Guess::Tangent => PlanRequest::GUESS_TANGENT,
            Guess::Wavefront => PlanRequest::GUESS_WAVEFRONT,
        },
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
