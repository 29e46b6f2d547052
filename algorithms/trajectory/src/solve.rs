//! Solution of a problem by a plan: along a curve, or by a search in the controls.

use crate::attempt::Attempts;
use crate::controls;
use crate::convex::effort::Effort;
use crate::corridors::corridors;
use crate::course::{CheckedTrajectory, Course};
use crate::curve_plan;
use crate::drive::trajectory_builder::Trajectory;
use crate::guide::previous_plan;
use crate::lower_bound::lower_bound;
use crate::plan::{Basis, Plan, PlanError, Sample, Status};
use navigation::tangent_graph::PathLeg;
use trajectory_problem::Method;
use trajectory_problem::Options;
use trajectory_problem::Problem;
use trajectory_problem::options::MAX_WORK;

/// Maximum number of corridors from which a search starts.
const CORRIDORS: usize = 4;
/// Maximum excess of a corridor's lower bound over that of the problem, relative to it.
const DETOUR: f64 = 1.0;

/// Duration of a word regardless of the obstacles, relative to the lower bound, below which it leads too far through them.
const DIRECT: f64 = 0.7;

/// Excess over the lower bound, relative to it, that counts as rounding: a plan is then proven optimal.
const PROVEN: f64 = 1e-6;
/// Largest error of a search's stages in the duration, relative to it.
const DISCRETISED: f64 = 2e-3;

/// Plans; `stop` is called regularly and returns `true` to end the search with the best result so
/// far.
///
/// A robot that turns quickly and whose speeds can step drives along a curve near the shortest path.
/// The plan of another robot, or among obstacles that leave no such curve near the lower bound, is the
/// fastest of several local optima in the controls.
///
/// `last` is the plan that the robot has been following, if its goal is the same: where it still
/// avoids all obstacles, the search begins near it.
///
/// # Errors
/// [`PlanError`] if the problem is not valid or has no solution.
pub fn plan(
    problem: &Problem,
    options: &Options,
    last: Option<&Plan>,
    stop: &mut dyn FnMut() -> bool,
) -> Result<Plan, PlanError> {
    problem.validate()?;
    options.validate()?;
    let course = Course::new(problem)?;
    let most = options.max_work.map_or(MAX_WORK, |most| most.min(MAX_WORK));
    let effort = Effort::new(Some(most));
    let steps = problem.limits.is_without_inertia();
    let searches = options.refine && options.method != Method::Tangent;
    // Without inertia the curve of another method is what was asked for.
    let improves = steps && options.method == Method::Bspline && options.fallbacks;
    let mut plan = None;
    let mut is_good = false;
    if searches && improves {
        let first = Options {
            fallbacks: false,
            ..*options
        };
        plan = curve_plan::plan(problem, &course, &first, last, &effort, stop).ok();
        is_good = plan
            .as_ref()
            .is_some_and(|plan| plan.final_time <= curve_plan::good(problem, &course) || stop());
    }
    let mut failed = None;
    if searches && (improves || !steps) && !is_good {
        let (found, failures) = plan_in_controls(problem, &course, options, last, &effort, stop);
        failed = Some(failures);
        let plans = plan.into_iter().chain(found);
        plan = plans.min_by(|a, b| a.final_time.total_cmp(&b.final_time));
    }
    let mut plan = match plan {
        Some(plan) => plan,
        None => curve_plan::plan(problem, &course, options, last, &effort, stop)?,
    };
    if plan.final_time <= plan.lower_bound * (1.0 + PROVEN) {
        plan.basis = Basis::Exact;
    }
    if plan.status == Status::Planned && plan.basis == Basis::Curve && failed.is_some() {
        plan.status = Status::Curve;
    }
    plan.failed_searches = failed.unwrap_or(0);
    plan.iterations = effort.programs();
    plan.work = effort.work();
    Ok(plan)
}

/// The plan of a search in the controls, `None` if there is none that passes the check, and the number of
/// searches that failed.
fn plan_in_controls(
    problem: &Problem,
    course: &Course,
    options: &Options,
    last: Option<&Plan>,
    effort: &Effort,
    stop: &mut dyn FnMut() -> bool,
) -> (Option<Plan>, u32) {
    let field = &course.obstacle_field;
    // The last plan kept the same limits: it is nearer to the optimum than any guess.
    let rest = last.and_then(|plan| previous_plan::rest(problem, field, plan, course.shortest));
    let mut found = controls::SearchResult::default();
    if let Some(rest) = rest {
        found = controls::search(
            problem,
            course,
            vec![rest.samples],
            |_| Vec::new(),
            effort,
            stop,
        );
    }
    let mut guesses = Vec::new();
    if found.optimum.is_none() {
        let rough = Problem {
            limits: problem.limits.without_inertia(),
            start_speed: None,
            start_turn_rate: None,
            goal_speed: None,
            ..problem.clone()
        };
        let most = lower_bound(problem, course.shortest) * (1.0 + DETOUR);
        let corridors = corridors(problem, &course.exact, CORRIDORS, most).unwrap_or_default();
        let paths: Vec<_> = corridors
            .into_iter()
            .map(|corridor| corridor.path.legs)
            .collect();
        guesses = self::guesses([problem, &rough], &paths, course, options, effort, stop);
        let more = |most: f64| crate::guesses::eased(&rough, &paths, most);
        let before = found.failed;
        found = controls::search(problem, course, guesses.clone(), more, effort, stop);
        found.failed += before;
    }
    let failed = found.failed;
    let found = found.optimum.and_then(|mut optimum| {
        // A rounding error of a speed that cannot step would be a step.
        if let (Some(last), Some(v)) = (optimum.samples.last_mut(), problem.goal_speed)
            && !problem.limits.is_without_inertia()
        {
            last.v = v;
        }
        let basis = Basis::Optimal {
            residual: optimum.residual,
        };
        checked(problem, course, optimum.samples).map(|checked| (checked, basis))
    });
    let least = found
        .as_ref()
        .map_or(f64::INFINITY, |found| found.0.trajectory.duration());
    let motion = exact(problem, course, guesses, least).map(|motion| {
        let basis = match &found {
            // The motion is the local optimum without its error of discretisation.
            Some((_, basis)) if motion.trajectory.duration() > least * (1.0 - DISCRETISED) => {
                *basis
            }
            _ => Basis::Curve,
        };
        (motion, basis)
    });
    let Some((checked, basis)) = motion.or(found) else {
        return (None, failed);
    };
    // The end of the work is no deadline: it comes at the same point on every machine.
    let status = if !effort.is_spent() && stop() {
        Status::Deadline
    } else {
        Status::Planned
    };
    let plan = Plan {
        status,
        method: options.method,
        final_time: checked.trajectory.duration(),
        lower_bound: lower_bound(problem, course.shortest),
        length: checked.trajectory.length(),
        min_clearance: checked.min_clearance,
        iterations: effort.programs(),
        work: effort.work(),
        control_points: 0,
        basis,
        failed_searches: failed,
        samples: checked.trajectory.into_samples(),
    };
    (Some(plan), failed)
}

/// The fastest guess that is valid and takes less than `least` (s), if speeds can step: in open space
/// the fastest motion is among the guesses, and has no error of discretisation.
fn exact(
    problem: &Problem,
    course: &Course,
    guesses: Vec<Vec<Sample>>,
    mut least: f64,
) -> Option<CheckedTrajectory> {
    let mut best = None;
    for samples in guesses {
        let duration = samples.last().map_or(f64::INFINITY, |last| last.t);
        if duration < least
            && problem.limits.is_without_inertia()
            && let Some(found) = checked(problem, course, samples)
        {
            least = duration;
            best = Some(found);
        }
    }
    best
}

/// A trajectory with the prescribed ends; `None` if it is not valid.
fn checked(problem: &Problem, course: &Course, samples: Vec<Sample>) -> Option<CheckedTrajectory> {
    let mut trajectory = Trajectory::from_samples(samples);
    trajectory.settle(problem.goal);
    trajectory.keep_ends(problem);
    CheckedTrajectory::new(problem, &course.obstacle_field, trajectory, 0)
}

/// Guesses of a search, of a robot without inertia.
fn guesses(
    [problem, rough]: [&Problem; 2],
    paths: &[Vec<PathLeg>],
    course: &Course,
    options: &Options,
    effort: &Effort,
    stop: &mut dyn FnMut() -> bool,
) -> Vec<Vec<Sample>> {
    let mut guesses = Vec::new();
    if options.method != Method::Bspline
        && let Some(guide) = &course.guide
    {
        let attempts = Attempts {
            problem: rough,
            obstacle_field: &course.obstacle_field,
            guide,
            shortest: course.shortest,
            options,
            rest: None,
            effort,
        };
        let curve = curve_plan::variants(rough)
            .next()
            .and_then(|variant| attempts.attempt(variant, stop));
        guesses.extend(curve.map(|candidate| candidate.trajectory.into_samples()));
    }
    // Words regardless of the obstacles are for robots that turn slowly.
    let steps = problem.limits.is_without_inertia();
    let direct = steps.then(|| DIRECT * lower_bound(problem, course.shortest));
    guesses.extend(crate::guesses::guesses(rough, paths, direct));
    guesses
}
