//! Solution of a problem by a plan.

use core::f64::consts::PI;

use crate::attempt::{Attempts, Candidate, Variant};
use crate::backwards;
use crate::convex::effort::Effort;
use crate::drive::shortest_path_plan;
use crate::drive::trajectory_builder::Trajectory;
use crate::drive::turn_in_place;
use crate::guesses::guesses;
use crate::guide::Guide;
use crate::guide::grid_guide;
use crate::guide::previous_plan;
use crate::lower_bound::lower_bound;
use crate::obstacle_field::{ExactObstacleField, ObstacleField};
use crate::options::{Guess, Options};
use crate::path_points;
use crate::plan::{Method, Plan, PlanError, Status};
use crate::problem::Problem;
use crate::validity_check;
use geometry::math;
use navigation::tangent_graph::PathLeg;

/// Gap to the lower bound, relative to it, below which the search ends; in addition to the cost of
/// turning into the shortest path on the spot.
const GOOD: f64 = 1e-3;
/// Maximum allowed share of these turning costs, relative to the lower bound.
const MAX_TURNING: f64 = 1.5e-3;

/// Gap to the lower bound, relative to it, up to which driving forwards is not compared to driving
/// backwards, nor a curve to the start guesses.
const NEARLY: f64 = 2.5e-3;

/// Maximum number of times that the breaks of splines are halved.
const MAX_LEVEL: u32 = 1;

/// Plans; `stop` is called regularly and returns `true` to end the search with the best result so
/// far.
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
    let effort = Effort::new(options.max_work);
    let best = either_way(problem, &course, options, last, &effort, stop)?;
    let has_words = options.method == Method::Bspline && options.fallbacks;
    let is_good = best.gap() <= NEARLY || !problem.limits.is_without_inertia();
    if is_good || !has_words || best.status == Status::Deadline || stop() {
        return Ok(best);
    }
    Ok(with_guesses(problem, &course, options, &effort, best))
}

/// The plan, or a start guess that is valid and faster: where turning is slow and no obstacle is near,
/// the fastest motion in free space is among them.
fn with_guesses(
    problem: &Problem,
    course: &Course,
    options: &Options,
    effort: &Effort,
    mut best: Plan,
) -> Plan {
    let legs: Vec<PathLeg> = course
        .guide
        .iter()
        .flat_map(Guide::legs)
        .map(|(_, leg)| *leg)
        .collect();
    for samples in guesses(problem, &legs) {
        let trajectory = Trajectory::from_samples(samples);
        if trajectory.duration() >= best.final_time {
            continue;
        }
        let Some(found) = Checked::new(problem, &course.obstacle_field, trajectory, 0) else {
            continue;
        };
        best = found.into_plan(Status::Planned, options.method, best.lower_bound, effort);
    }
    best
}

/// The faster of the plans ahead and, if the robot may reverse, backwards.
fn either_way(
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
    let mut best = match (forwards, backwards) {
        (Ok(a), Ok(b)) if b.final_time < a.final_time => b,
        (Ok(plan), _) | (Err(_), Ok(plan)) => plan,
        (Err(error), Err(_)) => return Err(error),
    };
    (best.iterations, best.work) = (effort.programs(), effort.work());
    Ok(best)
}

/// Returns `true` if driving backwards may beat driving forwards: where the robot then turns less, or
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

/// The obstacles of a problem, and the shortest path among them.
struct Course {
    obstacle_field: ObstacleField,
    exact: ExactObstacleField,
    /// Length of the shortest path (m).
    shortest: f64,
    /// The shortest path, if start and goal are not the same point.
    guide: Option<Guide>,
}

impl Course {
    fn new(problem: &Problem) -> Result<Self, PlanError> {
        let obstacle_field = ObstacleField::new(problem)?;
        let exact = obstacle_field.exact()?;
        let path = exact.shortest(problem.start.position(), problem.goal)?;
        if path.length > path_points::MAX_LENGTH {
            return Err(PlanError::Infeasible("the path is longer than 2 km"));
        }
        Ok(Self {
            obstacle_field,
            exact,
            shortest: path.length,
            guide: Guide::new(path.legs),
        })
    }
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
        let inertia = !problem.limits.is_without_inertia();
        let good = bound * (1.0 + GOOD) + turning_time(problem, guide).min(MAX_TURNING * bound);
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
        // The result of a search in the controls is a local optimum whatever the bound.
        let enough = if inertia && options.refine {
            f64::INFINITY
        } else {
            good
        };
        tried = try_curves(&bench, enough, stop);
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
    Ok(checked.into_plan(status, method, bound, effort))
}

/// A trajectory that has passed the check.
struct Checked {
    trajectory: Trajectory,
    /// Minimum distance of the path from grown obstacles (m).
    min_clearance: f64,
    control_points: usize,
}

impl Checked {
    /// Checks a trajectory; `None` if it does not pass.
    fn new(
        problem: &Problem,
        obstacle_field: &ObstacleField,
        trajectory: Trajectory,
        control_points: usize,
    ) -> Option<Self> {
        let report = validity_check::report(problem, obstacle_field, trajectory.samples());
        report.is_valid().then_some(Self {
            trajectory,
            min_clearance: report.min_clearance,
            control_points,
        })
    }

    /// The plan with this trajectory and this bound (s).
    fn into_plan(self, status: Status, method: Method, lower_bound: f64, effort: &Effort) -> Plan {
        Plan {
            status,
            method,
            final_time: self.trajectory.duration(),
            lower_bound,
            length: self.trajectory.length(),
            min_clearance: self.min_clearance,
            iterations: effort.programs(),
            work: effort.work(),
            control_points: self.control_points as u32,
            samples: self.trajectory.into_samples(),
        }
    }
}

/// Result of the curves of a method.
#[derive(Default)]
struct CurveAttempt {
    best: Option<Checked>,
    /// `true` if the search was stopped.
    stopped: bool,
}

/// Tries the variants in order until a plan takes no longer than `enough` (s).
fn try_curves(bench: &Attempts<'_>, enough: f64, stop: &mut dyn FnMut() -> bool) -> CurveAttempt {
    let effort = bench.effort;
    let mut stop = || effort.is_spent() || stop();
    let stop: &mut dyn FnMut() -> bool = &mut stop;
    let mut tried = CurveAttempt::default();
    let inertia = !bench.problem.limits.is_without_inertia();
    let most = if bench.options.fallbacks {
        usize::MAX
    } else {
        1
    };
    for variant in variants(bench.problem).take(most) {
        let mut candidate = bench.attempt(variant, stop);
        if inertia && bench.options.refine {
            candidate = candidate.map(|candidate| bench.refine(candidate, stop));
        }
        tried.stopped = stop();
        if let Some(Candidate {
            trajectory,
            control_points,
            rough: false,
        }) = candidate
        {
            let time = trajectory.duration();
            let best = tried.best.as_ref();
            let better = best.is_none_or(|best| time < best.trajectory.duration());
            let checked = better
                .then(|| {
                    Checked::new(
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
        if tried.stopped {
            break;
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
fn variants(problem: &Problem) -> impl Iterator<Item = Variant> {
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
) -> Result<Checked, PlanError> {
    let trajectory = shortest_path_plan::trajectory(problem, exact, guide)?;
    Checked::new(problem, obstacle_field, trajectory, 0).ok_or(PlanError::Infeasible(
        "the shortest path cannot be driven within the limits",
    ))
}
