//! Conversion of a received, untrusted request to a problem.

use geometry::pose::Pose2;
use geometry::shape::Aabb;
use ipc_types::messages::optimiser::PlanRequest;
use ipc_types::messages::world::ShapePoint;
use nalgebra::Point2;
use runtime::shapes::{self, ShapesMessageError};
use thiserror::Error;
use trajectory_problem::problem::{MAX_OBSTACLES, START_TOLERANCE};
use trajectory_problem::{
    Constraints, Guess, Method, Options, Problem, ProblemError, RobotLimits, Wheels,
};

// Clients know limit and codes without this crate.
const _: () = assert!(PlanRequest::MAX_SHAPES == MAX_OBSTACLES);
const _: () = assert!(
    PlanRequest::BSPLINE == Method::Bspline.code()
        && PlanRequest::LOCAL_PURSUIT == Method::Lp.code()
        && PlanRequest::MOTION_CAMOUFLAGE == Method::Vmc.code()
        && PlanRequest::TANGENT == Method::Tangent.code()
        && PlanRequest::GUESS_TANGENT == Guess::Tangent.code()
        && PlanRequest::GUESS_WAVEFRONT == Guess::Wavefront.code()
);

/// Work at which a plan of a robot without inertia, without a time limit, ends with its best trajectory so far: about
/// 15 ms of a processor. Others have the limit of all plans.
const MAX_WORK: u64 = 1 << 18;

/// Faults of a request that describes no problem.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RequestError {
    /// The obstacles are invalid.
    #[error("obstacles: {0}")]
    Shapes(#[from] ShapesMessageError),
    /// A field is invalid.
    #[error(transparent)]
    Problem(#[from] ProblemError),
}

fn refused(field: &str, value: impl core::fmt::Display, expected: &str) -> RequestError {
    RequestError::Problem(ProblemError {
        field: field.to_owned(),
        value: value.to_string(),
        expected: expected.to_owned(),
    })
}

/// Returns the problem and the options of a request, both within their ranges.
///
/// # Errors
/// [`RequestError`] names the invalid value.
pub fn decode_request(
    header: &PlanRequest,
    points: &[ShapePoint],
) -> Result<(Problem, Options), RequestError> {
    if points.len() > PlanRequest::MAX_POINTS {
        let expected = format!("at most {}", PlanRequest::MAX_POINTS);
        return Err(refused("obstacles", points.len(), &expected));
    }
    let [min_x, min_y, max_x, max_y] = header.bounds;
    let problem = Problem {
        start: Pose2 {
            x: header.start_x,
            y: header.start_y,
            theta: header.start_theta,
        },
        start_speed: unless_nan(header.start_v),
        start_turn_rate: unless_nan(header.start_omega),
        goal: Point2::new(header.goal_x, header.goal_y),
        goal_heading: unless_nan(header.goal_theta),
        goal_speed: unless_nan(header.goal_v),
        limits: limits(header),
        obstacles: shapes::pieces(header.shapes, points)?,
        clearance: header.clearance,
        bounds: Aabb {
            min: Point2::new(min_x, min_y),
            max: Point2::new(max_x, max_y),
        },
        start_tolerance: unless_nan(header.start_tolerance).unwrap_or(START_TOLERANCE),
    };
    problem.validate()?;
    Ok((problem, options(header)?))
}

fn limits(header: &PlanRequest) -> RobotLimits {
    let unless_infinite = |limit: f64| (limit != f64::INFINITY).then_some(limit);
    RobotLimits {
        v_max: header.v_max,
        v_min: header.v_min,
        omega_max: header.omega_max,
        wheels: unless_infinite(header.wheel_speed_max).map(|speed| Wheels {
            speed,
            separation: header.wheel_separation,
        }),
        acceleration: unless_infinite(header.acceleration_max),
        angular_acceleration: unless_infinite(header.angular_acceleration_max),
    }
}

fn options(header: &PlanRequest) -> Result<Options, RequestError> {
    let method = Method::from_code(header.method)
        .ok_or_else(|| refused("method", header.method, "a number from 0 to 3"))?;
    let guess =
        Guess::from_code(header.guess).ok_or_else(|| refused("guess", header.guess, "0 or 1"))?;
    let flags = header.flags;
    let known = PlanRequest::NO_FALLBACKS | PlanRequest::NO_REFINEMENT | PlanRequest::AT_NODES;
    if flags & !known != 0 {
        return Err(refused("flags", flags, "a sum of 1, 2 and 4"));
    }
    let is_limited = header.deadline_ns == 0 && limits(header).is_without_inertia();
    let (x, y) = (header.reference_x, header.reference_y);
    let options = Options {
        method,
        guess,
        constraints: if flags & PlanRequest::AT_NODES == 0 {
            Constraints::Dense
        } else {
            Constraints::Nodes
        },
        fallbacks: flags & PlanRequest::NO_FALLBACKS == 0,
        refine: flags & PlanRequest::NO_REFINEMENT == 0,
        degree: unless_zero(header.degree),
        control_points: unless_zero(header.control_points),
        nodes: unless_zero(header.nodes),
        reference_point: (!(x.is_nan() && y.is_nan())).then_some([x, y]),
        // A limit of time comes at another point on every machine.
        max_work: is_limited.then_some(MAX_WORK),
    };
    options.validate()?;
    Ok(options)
}

fn unless_nan(value: f64) -> Option<f64> {
    (!value.is_nan()).then_some(value)
}

fn unless_zero(value: u32) -> Option<usize> {
    (value != 0).then_some(value as usize)
}
