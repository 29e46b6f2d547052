//! Conversion of a request's result to its answer.

use ipc_types::messages::optimiser::{PlanRequest, PlanResponse, TrajectorySample};
use ipc_types::stamp::Stamp;
use thiserror::Error;
use trajectory::{Plan, PlanError, Status};

use super::decode_request::RequestError;

/// Reasons for which a request gets no plan.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Refusal {
    /// The request is invalid.
    #[error(transparent)]
    Request(#[from] RequestError),
    /// The planner found no plan.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A newer request of the same robot arrived.
    #[error("replaced by a newer request of robot {robot}")]
    Cancelled {
        /// The robot.
        robot: u32,
    },
    /// The trajectory exceeds the capacity of an answer.
    #[error(
        "the trajectory has {samples} samples, more than the {} of an answer",
        PlanResponse::MAX_SAMPLES
    )]
    TooLong {
        /// Its samples.
        samples: usize,
    },
    /// The planning panicked: a bug.
    #[error("the optimiser failed: {0}")]
    Failed(String),
}

impl Refusal {
    /// Returns `true` if the fault lies in the request itself.
    pub fn is_of_request(&self) -> bool {
        matches!(self, Self::Request(_) | Self::Plan(PlanError::Invalid(_)))
    }

    /// [`PlanResponse::status`].
    fn status(&self) -> u32 {
        match self {
            Self::Request(_) | Self::Plan(PlanError::Invalid(_)) => PlanResponse::INVALID,
            Self::Plan(PlanError::NoPath) => PlanResponse::NO_PATH,
            Self::Plan(PlanError::Infeasible(_) | PlanError::InvalidTrajectory) => {
                PlanResponse::INFEASIBLE
            }
            Self::Plan(PlanError::Stopped) => PlanResponse::OUT_OF_TIME,
            Self::Cancelled { .. } => PlanResponse::CANCELLED,
            Self::TooLong { .. } | Self::Failed(_) => PlanResponse::FAILED,
        }
    }
}

/// Returns the answer to a request: header, and samples of a plan.
pub fn encode_answer(
    request: &PlanRequest,
    result: &Result<Plan, Refusal>,
    solve_ns: u64,
) -> (PlanResponse, Vec<TrajectorySample>) {
    let header = PlanResponse {
        stamp: Stamp {
            tick: request.stamp.tick,
            time_ns: request.stamp.time_ns,
            sequence: request.stamp.sequence,
            origin_ns: request.stamp.origin_ns,
            received_ns: request.stamp.sent_ns,
            ..Stamp::default()
        },
        solve_ns,
        robot: request.robot,
        method: request.method,
        ..PlanResponse::default()
    };
    let too_long;
    let refusal = match result {
        Ok(plan) if plan.samples.len() <= PlanResponse::MAX_SAMPLES => {
            return (of_plan(&header, plan), samples(plan));
        }
        Ok(plan) => {
            let samples = plan.samples.len();
            too_long = Refusal::TooLong { samples };
            &too_long
        }
        Err(refusal) => refusal,
    };
    let header = PlanResponse {
        status: refusal.status(),
        reason: PlanResponse::reason_of(&refusal.to_string()),
        ..header
    };
    (header, Vec::new())
}

fn of_plan(header: &PlanResponse, plan: &Plan) -> PlanResponse {
    PlanResponse {
        final_time: plan.final_time,
        lower_bound: plan.lower_bound,
        length: plan.length,
        min_clearance: plan.min_clearance,
        method: plan.method.code(),
        iterations: plan.iterations,
        control_points: plan.control_points,
        failed_searches: plan.failed_searches,
        status: match plan.status {
            Status::Planned => PlanResponse::PLANNED,
            Status::Curve => PlanResponse::CURVE,
            Status::Fallback => PlanResponse::FALLBACK,
            Status::Deadline => PlanResponse::DEADLINE,
        },
        ..*header
    }
}

fn samples(plan: &Plan) -> Vec<TrajectorySample> {
    let samples = plan.samples.iter().map(|sample| TrajectorySample {
        time_s: sample.t,
        x: sample.x,
        y: sample.y,
        theta: sample.theta,
        v: sample.v,
        omega: sample.omega,
    });
    samples.collect()
}
