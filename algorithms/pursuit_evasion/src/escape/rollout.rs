//! The drive along a course, computed in advance.

use navigation::dominance::{Arena, Dominance};
use planner_view::map::PlannerMap;
use robot::spec::RobotModel;

use super::{Course, Robot};

/// Maximum time of a rollout: a factor of the time at top speed, and what is added to it for turns (s).
const MAX_TIME: (f64, f64) = (2.0, 10.0);

/// Maximum number of ticks of a rollout.
const MAX_TICKS: f64 = 1e5;

/// Result of a drive along a course to an exit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rollout {
    /// Index of the exit.
    pub exit: usize,
    /// Time of arrival (s).
    pub time: f64,
    /// Least time from the end of the next tick until a pursuer could stop the robot (s), a lower
    /// bound.
    pub lead: f64,
    /// Lead over the first pursuer at the exit (s), a lower bound.
    pub margin: f64,
}

impl Rollout {
    /// The drive of a robot along a course, against the pursuers of the last assessment; `None` if it
    /// touches an obstacle or does not arrive.
    pub fn from_course(
        map: &PlannerMap,
        arena: &Arena,
        dominance: &Dominance,
        course: &Course,
        robot: &Robot,
    ) -> Option<Self> {
        let RobotModel { radius, v_max, .. } = robot.model;
        let (limits, dt) = (robot.limits()?, robot.dt);
        let (mut robot, mut course) = (*robot, course.clone());
        let ticks = ((MAX_TIME.0 * course.left() / v_max + MAX_TIME.1) / dt).min(MAX_TICKS);
        let mut clearance = map.clearance(robot.pose.position());
        let mut lead = f64::INFINITY;
        // A cast of a float saturates; NaN becomes 0.
        for tick in 1..=ticks as u32 {
            let tracking = course.follow(map, &robot.pose, &limits)?;
            robot = robot.after(tracking.command);
            let here = robot.pose.position();
            let time = f64::from(tick) * dt;
            let spare = dominance.stopped_from(arena, here, radius) - time;
            lead = lead.min(spare - dt);
            let arrived = |exit: &usize| {
                arena
                    .exit(*exit)
                    .is_some_and(|region| region.contains(here))
            };
            if let Some(exit) = (0..arena.exits()).find(arrived) {
                return Some(Self {
                    exit,
                    time,
                    lead,
                    margin: spare,
                });
            }
            // A robot in contact may drive along or away.
            let before = clearance;
            clearance = map.clearance(here);
            if clearance < radius.min(before) {
                return None;
            }
        }
        None
    }

    /// Returns `true` if no pursuer can stop the robot on the way.
    pub fn is_safe(&self) -> bool {
        self.lead > 0.0
    }
}
