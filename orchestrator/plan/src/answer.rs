//! One problem, planned and judged.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

use rustix::time::{ClockId, clock_gettime};
use serde::{Deserialize, Serialize, Serializer};
use trajectory::{Method, Plan, PlanError, Sample, Status};

use super::field::FieldError;
use super::instance::Instance;
use super::options::PlanOptions;

/// How the planning of a problem ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// A plan by the method asked for.
    Planned,
    /// A plan: the exact shortest path, for the method found nothing that passed its check.
    Fallback,
    /// There is no path from the start to the goal: a right answer.
    NoPath,
    /// There are paths, but none on which the prescribed speeds can be kept: a right answer.
    Infeasible,
    /// The method found no trajectory that passes the check, and nothing else was to be tried.
    InvalidTrajectory,
    /// The instance is not one.
    Invalid,
    /// The planner broke down.
    Failed,
}

impl Outcome {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Planned,
        Self::Fallback,
        Self::NoPath,
        Self::Infeasible,
        Self::InvalidTrajectory,
        Self::Invalid,
        Self::Failed,
    ];

    /// Its name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Planned => "planned",
            Self::Fallback => "fallback",
            Self::NoPath => "no_path",
            Self::Infeasible => "infeasible",
            Self::InvalidTrajectory => "not_honest",
            Self::Invalid => "invalid",
            Self::Failed => "failed",
        }
    }
}

/// What came of one problem: a line of the results. Lengths in pixels of the instance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// Name of the instance.
    pub id: String,
    /// How it ended.
    pub status: Outcome,
    /// Whether the plan keeps everything that the instance asks for; `None` without a plan.
    pub honest: Option<bool>,
    /// Duration of the plan (s).
    pub t_s: Option<f64>,
    /// No plan can be shorter than this (s).
    pub lower_bound_s: Option<f64>,
    /// How much longer than that the plan is, relative to it.
    pub gap: Option<f64>,
    /// CPU time of the thread that planned (ms): of the quickest of all repetitions.
    pub cpu_ms: Option<f64>,
    /// Smallest distance of the path from a grown obstacle (px); `None` without obstacles.
    pub min_clearance: Option<f64>,
    /// The method that made the plan.
    pub method: Method,
    /// Convex programs solved.
    pub iterations: Option<u32>,
    /// Degrees of freedom of the curve; 0 for one without.
    pub control_points: Option<u32>,
    /// Length of the path (px).
    pub length: Option<f64>,
    /// Why there is no plan, or what is wrong with it.
    pub error: Option<String>,
    /// The plan: time (s), place (px), heading (rad), speed (px/s), turning rate (rad/s).
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "samples")]
    pub samples: Option<Vec<Sample>>,
}

/// Samples as lists of numbers.
#[expect(clippy::ref_option, reason = "what serde calls it with")]
fn samples<S: Serializer>(samples: &Option<Vec<Sample>>, to: S) -> Result<S::Ok, S::Error> {
    let lists = samples.iter().flatten();
    to.collect_seq(lists.map(|s| [s.t, s.x, s.y, s.theta, s.v, s.omega]))
}

impl Answer {
    /// There is no plan.
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
            length: None,
            error: Some(error),
            samples: None,
        }
    }

    /// The instance is not one.
    pub fn invalid(id: &str, method: Method, error: &FieldError) -> Self {
        Self::without_plan(id, method, Outcome::Invalid, error.to_string())
    }

    /// Whether it is an answer that the instance has: anything but one to an invalid instance, and
    /// a breakdown.
    pub fn is_answer(&self) -> bool {
        !matches!(self.status, Outcome::Invalid | Outcome::Failed)
    }

    /// A plan, judged against the instance.
    fn of(instance: &Instance, plan: &Plan) -> Self {
        let k = instance.scale();
        let report = trajectory_check::check(&instance.contract(), &plan.samples);
        let finite = |v: f64| v.is_finite().then_some(v);
        let status = match plan.status {
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
            length: finite(plan.length / k),
            error: (!report.is_valid()).then(|| report.to_string()),
            samples: Some(scaled.collect()),
        }
    }
}

/// CPU time of this thread (ms).
fn cpu_ms() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 * 1e3 + now.tv_nsec as f64 * 1e-6
}

/// Plans a problem, `repeat` times for the sake of its CPU time, and judges the plan; `None` if it
/// was interrupted.
pub fn solve(
    instance: &Instance,
    options: &PlanOptions,
    repeat: u32,
    interrupted: &AtomicBool,
) -> Option<Answer> {
    let (problem, scaled) = (instance.problem(), options.scaled(instance.scale()));
    let mut least = f64::INFINITY;
    let mut last = None;
    for _ in 0..repeat.max(1) {
        let begin = cpu_ms();
        let mut stop = || interrupted.load(Ordering::Relaxed);
        // One problem must not take the others with it.
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
        Ok(Ok(plan)) => Answer::of(instance, &plan),
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
