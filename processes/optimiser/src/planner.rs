//! From a problem to a plan.

use crate::bound::lower_bound;
use crate::candidate::{Bench, Candidate, Variant};
use crate::check;
use crate::ground::{ExactGround, Ground};
use crate::guide::Guide;
use crate::options::{Guess, Options};
use crate::plan::{Method, Plan, PlanError, Status};
use crate::problem::Problem;
use crate::tangent;
use crate::trajectory::Trajectory;
use crate::turning;
use crate::warm;
use crate::wavefront;
use sim_backend::math;

/// A gap to the lower bound below which nothing better is looked for, relative to it; besides what
/// it costs to turn into the shortest path on the spot.
const GOOD: f64 = 1e-3;
/// Length of what is left of the last plan, relative to the shortest path, up to which the search
/// begins there: what is longer goes another way.
const DETOUR: f64 = 1.03;
/// Most of these costs that is allowed, relative to the lower bound.
const MOST_TURNING: f64 = 1.5e-3;

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
/// `last` is the plan that the robot has been following, if it is on the same errand: where it still
/// leads past everything, the search begins near it.
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
    let ground = Ground::new(problem)?;
    let exact = ground.exact()?;
    let path = exact.shortest(problem.start.position(), problem.goal)?;
    let shortest = path.length;
    let bound = lower_bound(problem, shortest);
    let guide = Guide::new(path.legs);
    // Where the grid is too coarse for a wave to get through, the exact path is there.
    let coarse = match options.guess {
        Guess::Wavefront => wavefront::guide(&exact, problem.start.position(), problem.goal),
        Guess::Tangent => None,
    };
    let mut programs = 0;
    let mut best: Option<Candidate> = None;
    let mut stopped = false;
    if options.method != Method::Tangent
        && let Some(guide) = &guide
    {
        let mut bench = Bench {
            problem,
            ground: &ground,
            guide: coarse.as_ref().unwrap_or(guide),
            shortest,
            options,
            rest: last
                .and_then(|plan| warm::rest(problem, &ground, plan))
                .filter(|rest| rest.guide.length() <= DETOUR * shortest),
            programs: 0,
        };
        let good = bound * (1.0 + GOOD) + turning_time(problem, guide).min(MOST_TURNING * bound);
        let tries = if options.fallbacks { VARIANTS.len() } else { 1 };
        let inertia = !problem.limits.is_without_inertia();
        for variant in variants(problem).take(tries) {
            let mut candidate = bench.attempt(variant, stop);
            if inertia
                && options.refine
                && let Some(first) = &mut candidate
            {
                bench.refine(first, stop);
            }
            stopped = stop();
            if let Some(candidate) = candidate
                && !candidate.rough
            {
                let time = candidate.trajectory.duration();
                let better = best.as_ref().is_none_or(|b| time < b.trajectory.duration());
                let report = check::report(problem, &ground, candidate.trajectory.samples());
                if better && report.is_honest() {
                    best = Some(Candidate {
                        min_clearance: report.min_clearance,
                        ..candidate
                    });
                    if time <= good || (inertia && options.refine) {
                        break;
                    }
                }
            }
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
    if !options.fallbacks && options.method != Method::Tangent && guide.is_some() {
        return Err(if stopped {
            PlanError::Stopped
        } else {
            PlanError::NotHonest
        });
    }
    let certain = certain(problem, &ground, &exact, guide.as_ref())?;
    let status = match options.method {
        Method::Tangent => Status::Planned,
        _ if stopped => Status::Deadline,
        _ => Status::Fallback,
    };
    Ok(finish(Method::Tangent, status, certain))
}

/// How long [s] it takes to turn on the spot into a path and out of it.
fn turning_time(problem: &Problem, guide: &Guide) -> f64 {
    let time = |angle: f64| {
        let phases = turning::phases(&problem.limits, angle);
        phases.iter().map(|phase| phase.duration).sum::<f64>()
    };
    let into = math::angle_difference(guide.start_heading(), problem.start.theta);
    let out = problem.goal_heading.map_or(0.0, |heading| {
        let u = guide.heading(1.0);
        math::angle_difference(heading, math::atan2(u.y, u.x))
    });
    time(into) + time(out)
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
    if !report.is_honest() {
        return Err(PlanError::Infeasible(
            "the shortest path cannot be driven within the limits",
        ));
    }
    Ok(Candidate {
        trajectory,
        min_clearance: report.min_clearance,
        control_points: 0,
        rough: false,
    })
}
