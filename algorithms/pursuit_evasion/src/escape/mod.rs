//! Escapes that no pursuer can prevent.
//!
//! [`plan`] finds a path to an exit and tests it by a rollout: the drive of the robot, tick by tick, with
//! the follower that will drive it ([`Course`]), its turns and its limits, as the world computes it. At
//! every tick the robot must be where no pursuer could stop it before the end of the next one
//! ([`Dominance::stopped_from`]): pursuers that turn at once, drive at top speed, know the path and
//! do not block each other, so that no pursuer is ever earlier.
//!
//! The path comes from [`navigation::dominance`], where turning takes no time. If the rollout is late
//! somewhere, the path is planned again for a start that is later by as much, which keeps it farther
//! from the pursuers.
//!
//! An evader that follows the course escapes whatever the pursuers do, if its drive is exact, commands
//! are at most one tick late, and no other evader stands in its way.

mod course;
mod robot;
mod rollout;

pub use course::Course;
pub use robot::Robot;
pub use rollout::Rollout;

use navigation::dominance::{Arena, Dominance, Runner};
use planner_view::map::PlannerMap;

/// Maximum number of paths tried for one verdict.
const MAX_PATHS: usize = 6;

/// An escape that no pursuer can prevent.
#[derive(Debug, Clone, PartialEq)]
pub struct Escape {
    /// The course to follow from now on.
    pub course: Course,
    /// Index of the exit.
    pub exit: usize,
    /// Time of the escape (s from now).
    pub time: f64,
    /// Lead over the first pursuer at the exit (s), a lower bound; ∞ without pursuers.
    pub margin: f64,
}

/// An escape of the evader `index` of the last assessment, if one is found that no pursuer can
/// prevent. `runner` is the evader as it was assessed, `robot` the same with its drive.
///
/// Changes the places that this evader safely reaches ([`Dominance::safe`]) to those of a later start.
pub fn plan(
    map: &PlannerMap,
    arena: &Arena,
    dominance: &mut Dominance,
    index: usize,
    runner: &Runner,
    robot: &Robot,
) -> Option<Escape> {
    let mut delay = 0.0;
    for _ in 0..MAX_PATHS {
        let (exit, node) = dominance.safest_exit(arena, index)?;
        let course = Course::to_exit(map, arena, dominance.safe(index)?, exit, node, robot)?;
        let rollout = Rollout::from_course(map, arena, dominance, &course, robot)?;
        if rollout.is_safe() {
            return Some(Escape {
                course,
                exit: rollout.exit,
                time: rollout.time,
                margin: rollout.margin,
            });
        }
        delay += (-rollout.lead).max(robot.dt);
        dominance.delay(map, arena, index, runner, delay);
    }
    None
}
