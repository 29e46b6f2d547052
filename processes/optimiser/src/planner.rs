//! From a problem to a plan.

use crate::bound::lower_bound;
use crate::candidate::{Bench, Candidate, Variant};
use crate::check;
use crate::ground::{ExactGround, Ground};
use crate::guide::Guide;
use crate::options::Options;
use crate::plan::{Method, Plan, PlanError, Status};
use crate::problem::Problem;
use crate::tangent;
use crate::trajectory::Trajectory;

/// A gap to the lower bound below which nothing better is looked for.
const GOOD: f64 = 1e-3;

/// The tries, one after the other.
const VARIANTS: [Variant; 6] = [
    Variant {
        turn_at_start: false,
        turn_at_goal: false,
        level: 0,
    },
    Variant {
        turn_at_start: true,
        turn_at_goal: false,
        level: 0,
    },
    Variant {
        turn_at_start: false,
        turn_at_goal: true,
        level: 0,
    },
    Variant {
        turn_at_start: true,
        turn_at_goal: true,
        level: 0,
    },
    Variant {
        turn_at_start: false,
        turn_at_goal: false,
        level: 1,
    },
    Variant {
        turn_at_start: true,
        turn_at_goal: true,
        level: 1,
    },
];

/// Plans; `stop` is asked now and then whether to answer with what there is.
///
/// `warm` is the plan that the robot has been following, if it is the same errand: its path is
/// tried as a start, too.
///
/// # Errors
/// [`PlanError`] if the problem is not valid or has no solution.
pub fn plan(
    problem: &Problem,
    options: &Options,
    warm: Option<&Plan>,
    stop: &mut dyn FnMut() -> bool,
) -> Result<Plan, PlanError> {
    let _ = warm;
    problem.validate()?;
    let ground = Ground::new(problem)?;
    let exact = ground.exact()?;
    let path = exact.shortest(problem.start.position(), problem.goal)?;
    let bound = lower_bound(problem, path.length);
    let guide = Guide::new(path.legs);
    let mut programs = 0;
    let mut best: Option<Candidate> = None;
    let mut stopped = false;
    if options.method != Method::Tangent
        && let Some(guide) = &guide
    {
        let mut bench = Bench {
            problem,
            ground: &ground,
            guide,
            options,
            programs: 0,
        };
        for variant in variants(problem) {
            let Some(candidate) = bench.attempt(variant, stop) else {
                stopped = stop();
                if stopped { break } else { continue }
            };
            let time = candidate.trajectory.duration();
            let better = best.as_ref().is_none_or(|b| time < b.trajectory.duration());
            if !better {
                continue;
            }
            let report = check::report(problem, &ground, candidate.trajectory.samples());
            if std::env::var_os("DBG").is_some() {
                for v in &report.violations {
                    eprintln!("  {variant:?} {v}");
                }
            }
            if report.is_honest() {
                best = Some(Candidate {
                    min_clearance: report.min_clearance,
                    ..candidate
                });
                if time <= bound * (1.0 + GOOD) {
                    break;
                }
            }
            stopped = stop();
            if stopped {
                break;
            }
        }
        programs = bench.programs;
    }
    let finish = |method: Method, status: Status, candidate: Candidate| Plan {
        status,
        method,
        final_time: candidate.trajectory.duration(),
        lower_bound: bound,
        length: candidate.trajectory.length(),
        min_clearance: candidate.min_clearance,
        iterations: programs,
        control_points: candidate.control_points as u32,
        samples: candidate.trajectory.into_samples(),
    };
    if let Some(best) = best {
        let status = if stopped {
            Status::Deadline
        } else {
            Status::Planned
        };
        return Ok(finish(options.method, status, best));
    }
    let certain = certain(problem, &ground, &exact, guide.as_ref())?;
    let status = match options.method {
        Method::Tangent => Status::Planned,
        _ if stopped => Status::Deadline,
        _ => Status::Fallback,
    };
    Ok(finish(Method::Tangent, status, certain))
}

/// The tries that make sense for a problem.
fn variants(problem: &Problem) -> impl Iterator<Item = Variant> {
    // Who turns on the spot stands: a robot with inertia must not be moving.
    let limits = &problem.limits;
    let moves = problem.start_speed.is_some_and(|v| v > 0.0) && limits.acceleration.is_some();
    let turns =
        problem.start_turn_rate.is_some_and(|w| w != 0.0) && limits.angular_acceleration.is_some();
    let leaves = problem.goal_speed.is_some_and(|v| v > 0.0) && limits.acceleration.is_some();
    let goal = problem.goal_heading.is_some() && !leaves;
    VARIANTS.into_iter().filter(move |variant| {
        (!variant.turn_at_start || !(moves || turns)) && (!variant.turn_at_goal || goal)
            || (variant.turn_at_start && variant.turn_at_goal && variant.level > 0)
    })
}

/// The exact shortest path, driven and checked.
fn certain(
    problem: &Problem,
    ground: &Ground,
    exact: &ExactGround,
    guide: Option<&Guide>,
) -> Result<Candidate, PlanError> {
    let trajectory: Trajectory = tangent::trajectory(problem, exact, guide)?;
    let report = check::report(problem, ground, trajectory.samples());
    if std::env::var_os("DBG").is_some() {
        for v in &report.violations {
            eprintln!("  tangent {v}");
        }
    }
    if !report.is_honest() {
        return Err(PlanError::Infeasible(
            "the shortest path cannot be driven within the limits",
        ));
    }
    Ok(Candidate {
        trajectory,
        min_clearance: report.min_clearance,
        control_points: 0,
    })
}
