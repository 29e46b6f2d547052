//! Planning of one problem and the check of its plan.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

use rustix::time::{ClockId, clock_gettime};
use serde::{Deserialize, Serialize, Serializer};
use trajectory::{Method, Plan, PlanError, Sample, Status};

use super::field::FieldError;
use super::instance::Instance;
use trajectory_problem::Options;

/// Result of planning a problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// A plan by the requested method.
    Planned,
    /// A curve of the requested method, since the search in the controls succeeded nowhere near it.
    Curve,
    /// A plan along the exact shortest path, since the method found none that passes its check.
    Fallback,
    /// There is no path from the start to the goal; a valid answer.
    NoPath,
    /// There are paths, but the prescribed speeds are impossible on all of them; a valid answer.
    Infeasible,
    /// The method found no trajectory that passes the check, and fallbacks are disabled or failed.
    #[serde(rename = "not_honest")]
    InvalidTrajectory,
    /// The instance is invalid.
    Invalid,
    /// The planner panicked.
    Failed,
}

impl Outcome {
    /// All outcomes.
    pub const ALL: [Self; 8] = [
        Self::Planned,
        Self::Curve,
        Self::Fallback,
        Self::NoPath,
        Self::Infeasible,
        Self::InvalidTrajectory,
        Self::Invalid,
        Self::Failed,
    ];

    /// Returns its name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Planned => "planned",
            Self::Curve => "curve",
            Self::Fallback => "fallback",
            Self::NoPath => "no_path",
            Self::Infeasible => "infeasible",
            Self::InvalidTrajectory => "not_honest",
            Self::Invalid => "invalid",
            Self::Failed => "failed",
        }
    }
}

/// Result of one problem: a line of the results. Lengths are in pixels of the instance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// Name of the instance.
    pub id: String,
    /// Outcome of the planning.
    pub status: Outcome,
    /// `true` if the plan meets all conditions of the instance; `None` without a plan.
    pub honest: Option<bool>,
    /// Duration of the plan (s).
    pub t_s: Option<f64>,
    /// Lower bound of the duration of any plan (s).
    pub lower_bound_s: Option<f64>,
    /// Excess of the plan's duration over the lower bound, relative to the bound.
    pub gap: Option<f64>,
    /// CPU time of the planning thread (ms): minimum of all repetitions.
    pub cpu_ms: Option<f64>,
    /// Minimum distance of the path from a grown obstacle (px); `None` without obstacles.
    pub min_clearance: Option<f64>,
    /// Method that made the plan.
    pub method: Method,
    /// Number of convex programs of curves and of steps of searches in the controls.
    pub iterations: Option<u32>,
    /// Degrees of freedom of the curve; 0 for a plan without one.
    pub control_points: Option<u32>,
    /// Evidence of the plan's quality: `optimal` (a local optimum in the controls), `exact` (proven: as
    /// fast as the lower bound) or `curve` (none).
    pub basis: Option<&'static str>,
    /// Number of searches in the controls that failed.
    pub failed_searches: Option<u32>,
    /// Largest error of the first-order conditions of a local optimum in the controls, with the
    /// duration as the unit of time; `None` for another plan.
    pub residual: Option<f64>,
    /// Length of the path (px).
    pub length: Option<f64>,
    /// Reason for the lack of a plan, or fault of the plan.
    pub error: Option<String>,
    /// Samples of the plan: time (s), position (px), heading (rad), speed (px/s), turning rate (rad/s).
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "samples")]
    pub samples: Option<Vec<Sample>>,
}

/// Writes samples as lists of numbers.
#[expect(clippy::ref_option, reason = "required by serde")]
fn samples<S: Serializer>(samples: &Option<Vec<Sample>>, to: S) -> Result<S::Ok, S::Error> {
    let lists = samples.iter().flatten();
    to.collect_seq(lists.map(|s| [s.t, s.x, s.y, s.theta, s.v, s.omega]))
}

impl Answer {
    /// Creates an answer without a plan.
    fn without_plan(id: &str, method: Method, status: Outcome, error: String) -> Self {
        Self {
            id: id.to_owned(),
            status,
            honest: None,
            t_s: None,
            lower_bound_s: None,
            gap: None,
            cpu_ms: None,
            min_clearance: None,
            method,
            iterations: None,
            control_points: None,
            basis: None,
            failed_searches: None,
            residual: None,
            length: None,
            error: Some(error),
            samples: None,
        }
    }

    /// Creates the answer to an invalid instance.
    pub fn invalid(id: &str, method: Method, error: &FieldError) -> Self {
        Self::without_plan(id, method, Outcome::Invalid, error.to_string())
    }

    /// Returns `true` if this is a result of a valid instance, and not of a panic.
    pub fn is_answer(&self) -> bool {
        !matches!(self.status, Outcome::Invalid | Outcome::Failed)
    }

    /// Creates the answer of a plan, checked against the instance.
    fn from_plan(instance: &Instance, plan: &Plan) -> Self {
        let k = instance.scale();
        let report = trajectory_check::check(&instance.contract(), &plan.samples);
        let finite = |v: f64| v.is_finite().then_some(v);
        let status = match plan.status {
            Status::Curve => Outcome::Curve,
            Status::Fallback => Outcome::Fallback,
            Status::Planned | Status::Deadline => Outcome::Planned,
        };
        let scaled = plan.samples.iter().map(|s| Sample {
            x: s.x / k,
            y: s.y / k,
            v: s.v / k,
            ..*s
        });
        Self {
            id: instance.id.clone(),
            status,
            honest: Some(report.is_valid()),
            t_s: finite(plan.final_time),
            lower_bound_s: finite(plan.lower_bound),
            gap: finite(plan.gap()),
            cpu_ms: None,
            min_clearance: finite(report.min_clearance / k),
            method: plan.method,
            iterations: Some(plan.iterations),
            control_points: Some(plan.control_points),
            basis: Some(plan.basis.name()),
            failed_searches: Some(plan.failed_searches),
            residual: plan.basis.residual(),
            length: finite(plan.length / k),
            error: (!report.is_valid()).then(|| report.to_string()),
            samples: Some(scaled.collect()),
        }
    }
}

/// Returns the CPU time of this thread (ms).
fn cpu_ms() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 * 1e3 + now.tv_nsec as f64 * 1e-6
}

/// Plans a problem `repeat` times, to measure its CPU time, and checks the plan. Returns `None` if it was
/// interrupted.
pub fn solve(
    instance: &Instance,
    options: &Options,
    repeat: u32,
    interrupted: &AtomicBool,
) -> Option<Answer> {
    let (problem, scaled) = (instance.problem(), options.scaled(instance.scale()));
    let mut least = f64::INFINITY;
    let mut last = None;
    for _ in 0..repeat.max(1) {
        let begin = cpu_ms();
        let mut stop = || interrupted.load(Ordering::Relaxed);
        // A panic in one problem must not end the others.
        let planned = catch_unwind(AssertUnwindSafe(|| {
            trajectory::plan(&problem, &scaled, None, &mut stop)
        }));
        least = least.min(cpu_ms() - begin);
        last = Some(planned);
    }
    if interrupted.load(Ordering::Relaxed) {
        return None;
    }
    let without = |status: Outcome, error: String| {
        Answer::without_plan(&instance.id, options.method, status, error)
    };
    let answer = match last? {
        Ok(Ok(plan)) => Answer::from_plan(instance, &plan),
        Ok(Err(error)) => {
            let status = match &error {
                PlanError::NoPath => Outcome::NoPath,
                PlanError::Infeasible(_) => Outcome::Infeasible,
                PlanError::InvalidTrajectory => Outcome::InvalidTrajectory,
                PlanError::Invalid(_) => Outcome::Invalid,
                PlanError::Stopped => Outcome::Failed,
            };
            let units = if status == Outcome::Invalid {
                " (in SI units)"
            } else {
                ""
            };
            without(status, format!("{error}{units}"))
        }
        Err(_) => without(
            Outcome::Failed,
            "the planner panicked; please report the instance".to_owned(),
        ),
    };
    Some(Answer {
        cpu_ms: Some(least),
        ..answer
    })
}
