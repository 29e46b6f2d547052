//! Plans along curves: the variants of a method, forwards and backwards, and the fallback.

use core::f64::consts::PI;

use crate::attempt::{Attempts, Candidate, Variant};
use crate::backwards;
use crate::convex::effort::Effort;
use crate::course::{CheckedTrajectory, Course};
use crate::drive::shortest_path_plan;
use crate::drive::turn_in_place;
use crate::guide::Guide;
use crate::guide::grid_guide;
use crate::guide::previous_plan;
use crate::lower_bound::lower_bound;
use crate::obstacle_field::{ExactObstacleField, ObstacleField};
use crate::plan::{Basis, Plan, PlanError, Status};
use geometry::math;
use trajectory_problem::Method;
use trajectory_problem::Problem;
use trajectory_problem::{Guess, Options};

/// Gap to the lower bound, relative to it, below which the search ends; in addition to the cost of
/// turning into the shortest path on the spot.
const GOOD: f64 = 1e-3;
/// Maximum allowed share of these turning costs, relative to the lower bound.
const MAX_TURNING: f64 = 1.5e-3;

/// Gap to the lower bound, relative to it, up to which driving forwards is not compared to driving
/// backwards.
const NEARLY: f64 = 2.5e-3;

/// Maximum number of times that the breaks of splines are halved.
const MAX_LEVEL: u32 = 1;

/// Plans along curves of the method, forwards and backwards; the exact shortest path if no curve
/// passes the check and alternatives are allowed.
///
/// # Errors
/// [`PlanError`] if there is no plan.
pub fn plan(
    problem: &Problem,
    course: &Course,
    options: &Options,
    last: Option<&Plan>,
    effort: &Effort,
    stop: &mut dyn FnMut() -> bool,
) -> Result<Plan, PlanError> {
    let forwards = plan_forwards(problem, course, options, last, effort, stop);
    let turned = backwards::problem(problem);
    if !problem.limits.may_reverse() || !may_gain(&forwards, problem, &turned, course) {
        return forwards;
    }
    if stop() {
        let status = Status::Deadline;
        return forwards.map(|plan| Plan { status, ..plan });
    }
    let last = last.map(|last| backwards::plan(last.clone(), PI));
    let backwards = plan_forwards(&turned, course, options, last.as_ref(), effort, stop)
        .map(|plan| backwards::plan(plan, -PI));
    match (forwards, backwards) {
        (Ok(a), Ok(b)) if b.final_time < a.final_time => Ok(b),
        (Ok(plan), _) | (Err(_), Ok(plan)) => Ok(plan),
        (Err(error), Err(_)) => Err(error),
    }
}

/// Duration (s) up to which a plan is good: hardly longer than the lower bound and the necessary
/// turns.
pub fn good(problem: &Problem, course: &Course) -> f64 {
    let bound = lower_bound(problem, course.shortest);
    let turning = course
        .guide
        .as_ref()
        .map_or(0.0, |guide| turning_time(problem, guide));
    bound * (1.0 + GOOD) + turning.min(MAX_TURNING * bound)
}

/// Returns `true` if driving backwards may be faster than driving forwards: where the robot then turns less, or
/// there is no plan forwards.
fn may_gain(
    forwards: &Result<Plan, PlanError>,
    problem: &Problem,
    turned: &Problem,
    course: &Course,
) -> bool {
    match (forwards, &course.guide) {
        (Ok(plan), Some(guide)) => {
            plan.gap() > NEARLY
                && !reverses_at_ends(turned)
                && turning_time(turned, guide) < turning_time(problem, guide)
        }
        (Err(PlanError::Infeasible(_) | PlanError::InvalidTrajectory), _) => true,
        _ => false,
    }
}

/// Returns `true` if the robot is prescribed to drive backwards at an end, where its speed cannot
/// step.
fn reverses_at_ends(problem: &Problem) -> bool {
    let ends = [problem.start_speed, problem.goal_speed];
    problem.limits.acceleration.is_some() && ends.iter().flatten().any(|&v| v < 0.0)
}

/// Plans without driving backwards, except to stop from a speed backwards.
fn plan_forwards(
    problem: &Problem,
    course: &Course,
    options: &Options,
    last: Option<&Plan>,
    effort: &Effort,
    stop: &mut dyn FnMut() -> bool,
) -> Result<Plan, PlanError> {
    let Course {
        obstacle_field,
        exact,
        shortest,
        guide,
    } = course;
    let bound = lower_bound(problem, *shortest);
    // Where the grid is too coarse for a wave to pass, the exact path is used.
    let coarse = match options.guess {
        Guess::Wavefront => grid_guide::guide(exact, problem.start.position(), problem.goal),
        Guess::Tangent => None,
    };
    let mut tried = CurveAttempt::default();
    if options.method != Method::Tangent
        && !reverses_at_ends(problem)
        && let Some(guide) = guide
    {
        let bench = Attempts {
            problem,
            obstacle_field,
            guide: coarse.as_ref().unwrap_or(guide),
            shortest: *shortest,
            options,
            rest: last
                .and_then(|plan| previous_plan::rest(problem, obstacle_field, plan, *shortest)),
            effort,
        };
        tried = try_curves(&bench, good(problem, course), stop);
    }
    let (checked, method, status) = match tried.best {
        Some(best) if tried.stopped => (best, options.method, Status::Deadline),
        Some(best) => (best, options.method, Status::Planned),
        None if options.method == Method::Tangent || guide.is_none() || options.fallbacks => {
            let fallback = fallback(problem, obstacle_field, exact, guide.as_ref())?;
            let status = match options.method {
                Method::Tangent => Status::Planned,
                // Without a path there is no curve to find.
                _ if guide.is_none() => Status::Planned,
                _ if tried.stopped => Status::Deadline,
                _ => Status::Fallback,
            };
            (fallback, Method::Tangent, status)
        }
        None if tried.stopped => return Err(PlanError::Stopped),
        None => return Err(PlanError::InvalidTrajectory),
    };
    Ok(Plan {
        status,
        method,
        final_time: checked.trajectory.duration(),
        lower_bound: bound,
        length: checked.trajectory.length(),
        min_clearance: checked.min_clearance,
        iterations: effort.programs(),
        work: effort.work(),
        control_points: checked.control_points as u32,
        basis: Basis::Curve,
        failed_searches: 0,
        samples: checked.trajectory.into_samples(),
    })
}

/// Result of the curves of a method.
#[derive(Default)]
struct CurveAttempt {
    best: Option<CheckedTrajectory>,
    /// `true` if the search was stopped.
    stopped: bool,
}

/// Tries the variants in order until a plan takes no longer than `enough` (s).
fn try_curves(bench: &Attempts<'_>, enough: f64, stop: &mut dyn FnMut() -> bool) -> CurveAttempt {
    let effort = bench.effort;
    let mut stop = || effort.is_spent() || stop();
    let stop: &mut dyn FnMut() -> bool = &mut stop;
    let mut tried = CurveAttempt {
        stopped: stop(),
        ..CurveAttempt::default()
    };
    let most = if bench.options.fallbacks {
        usize::MAX
    } else {
        1
    };
    for variant in variants(bench.problem).take(most) {
        if tried.stopped {
            break;
        }
        let candidate = bench.attempt(variant, stop);
        tried.stopped = stop();
        if let Some(Candidate {
            trajectory,
            control_points,
        }) = candidate
        {
            let time = trajectory.duration();
            let best = tried.best.as_ref();
            let better = best.is_none_or(|best| time < best.trajectory.duration());
            let checked = better
                .then(|| {
                    CheckedTrajectory::new(
                        bench.problem,
                        bench.obstacle_field,
                        trajectory,
                        control_points,
                    )
                })
                .flatten();
            if checked.is_some() {
                tried.best = checked;
                if time <= enough {
                    break;
                }
            }
        }
    }
    // The end of the work is no deadline: it comes at the same point on every machine.
    tried.stopped &= !effort.is_spent();
    tried
}

/// Time (s) for turning on the spot into a path and out of it.
fn turning_time(problem: &Problem, guide: &Guide) -> f64 {
    let time = |angle: f64| {
        let phases = turn_in_place::phases(&problem.limits, angle);
        phases.iter().map(|phase| phase.duration).sum::<f64>()
    };
    let into = math::angle_difference(guide.start_heading(), problem.start.theta);
    let out = problem.goal_heading.map_or(0.0, |heading| {
        let u = guide.heading(1.0);
        math::angle_difference(heading, math::atan2(u.y, u.x))
    });
    time(into) + time(out)
}

/// The sensible attempts for a problem, in order: first those with the fewest turns on the spot,
/// then the same with finer splines.
pub fn variants(problem: &Problem) -> impl Iterator<Item = Variant> {
    // A turn on the spot requires standstill: a robot with inertia must not be moving.
    let limits = &problem.limits;
    let moves = problem.start_speed.is_some_and(|v| v != 0.0) && limits.acceleration.is_some();
    let turns =
        problem.start_turn_rate.is_some_and(|w| w != 0.0) && limits.angular_acceleration.is_some();
    let leaves = problem.goal_speed.is_some_and(|v| v != 0.0) && limits.acceleration.is_some();
    let may_turn_at_start = !(moves || turns);
    let may_turn_at_goal = problem.goal_heading.is_some() && !leaves;
    let either = |may: bool| [Some(false), may.then_some(true)].into_iter().flatten();
    (0..=MAX_LEVEL).flat_map(move |level| {
        either(may_turn_at_goal).flat_map(move |turn_at_goal| {
            either(may_turn_at_start).map(move |turn_at_start| Variant {
                turn_at_start,
                turn_at_goal,
                level,
            })
        })
    })
}

/// The checked trajectory along the exact shortest path.
fn fallback(
    problem: &Problem,
    obstacle_field: &ObstacleField,
    exact: &ExactObstacleField,
    guide: Option<&Guide>,
) -> Result<CheckedTrajectory, PlanError> {
    let trajectory = shortest_path_plan::trajectory(problem, exact, guide)?;
    CheckedTrajectory::new(problem, obstacle_field, trajectory, 0).ok_or(PlanError::Infeasible(
        "the shortest path cannot be driven within the limits",
    ))
}
