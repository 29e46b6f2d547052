//! Lower bound on the duration.

use free_motion::{Heading, Speeds};

use crate::drive::turn_in_place;
use geometry::math;
use trajectory_problem::{Problem, RobotLimits};

/// A lower bound (s) on the duration of every trajectory that solves a problem whose shortest path
/// has this length (m).
///
/// The robot must cover at least the shortest path. So it needs at least as long as a point on a
/// line that covers that distance with the same limits and prescribed speeds (turns on the path
/// only cost more). Where both headings are prescribed, it needs at least as long as a turn from
/// one to the other on the spot. Without acceleration limits this is L*/Vmax.
///
/// A robot that may drive backwards is no faster than that point, whose speed is the magnitude of
/// the robot's; between prescribed speeds of different directions it must also reverse.
///
/// A robot that turns slowly needs at least as long as without obstacles and inertia
/// ([`free_motion::least_time`]).
pub fn lower_bound(problem: &Problem, shortest: f64) -> f64 {
    let limits = &problem.limits;
    let (start, goal) = (problem.start_speed, problem.goal_speed);
    let straight = straight(limits, shortest, start.map(f64::abs), goal.map(f64::abs));
    let reversal = match (start, goal, limits.acceleration) {
        (Some(v0), Some(v1), Some(a)) => (v1 - v0).abs() / a,
        _ => 0.0,
    };
    let turn = problem.goal_heading.map_or(0.0, |heading| {
        let angle = math::angle_difference(heading, problem.start.theta).abs();
        let from = problem.start_turn_rate.map(f64::abs);
        // Turning during the motion may help or not; the bound assumes that it does.
        turn_in_place::least_duration(limits, angle, from.unwrap_or(limits.top_turn_rate()))
    });
    let speeds = Speeds {
        v: limits.top_speed(),
        omega: limits.top_turn_rate(),
        reverse: limits.may_reverse(),
    };
    let heading = problem.goal_heading.map_or(Heading::Free, Heading::At);
    let turning = free_motion::least_time(&speeds, &problem.start, problem.goal, heading);
    straight.max(turn).max(reversal).max(turning)
}

/// Minimum duration (s) of a motion along a line over at least this length (m), between speeds that
/// are prescribed or free.
fn straight(limits: &RobotLimits, length: f64, start: Option<f64>, end: Option<f64>) -> f64 {
    let top = limits.top_speed();
    let Some(a) = limits.acceleration else {
        return length / top;
    };
    // A free speed is the highest one from which the other end can be reached.
    let within_reach = |v: f64| (v * v + 2.0 * a * length).sqrt().min(top);
    let (v0, v1) = match (start, end) {
        (None, None) => return length / top,
        (Some(v), None) => (v.min(top), within_reach(v)),
        (None, Some(v)) => (within_reach(v), v.min(top)),
        (Some(v0), Some(v1)) => (v0.min(top), v1.min(top)),
    };
    // Below this length it cannot change from one speed to the other: it takes a longer path.
    let ramp = (v1 * v1 - v0 * v0).abs() / (2.0 * a);
    let length = length.max(ramp);
    // Accelerate to the peak, drive, decelerate.
    let peak = (0.5 * (v0 * v0 + v1 * v1) + a * length).sqrt().min(top);
    let ramps = (2.0 * peak * peak - v0 * v0 - v1 * v1) / (2.0 * a);
    (2.0 * peak - v0 - v1) / a + (length - ramps).max(0.0) / peak.max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_inertia_it_is_the_length_at_full_speed() {
        let limits = RobotLimits::simple(0.5, 2.0);
        assert_eq!(straight(&limits, 3.0, None, None), 6.0);
        assert_eq!(straight(&limits, 3.0, Some(0.0), Some(0.0)), 6.0);
    }

    #[test]
    fn with_inertia_it_is_a_trapezoid_or_a_triangle() {
        let limits = RobotLimits {
            acceleration: Some(0.5),
            ..RobotLimits::simple(1.0, 2.0)
        };
        // 2 s up over 1 m, 3 s at full speed, 2 s down.
        assert!((straight(&limits, 5.0, Some(0.0), Some(0.0)) - 7.0).abs() < 1e-12);
        // Up to √0.5 and down again.
        let triangle = 2.0 * 0.5f64.sqrt() / 0.5;
        assert!((straight(&limits, 1.0, Some(0.0), Some(0.0)) - triangle).abs() < 1e-12);
        assert!((straight(&limits, 5.0, None, None) - 5.0).abs() < 1e-12);
        // From rest as far as possible: 0.25 m in 1 s.
        assert!((straight(&limits, 0.25, Some(0.0), None) - 1.0).abs() < 1e-12);
        assert!((straight(&limits, 0.25, None, Some(0.0)) - 1.0).abs() < 1e-12);
        // Stopping takes 1 m, even if the goal is nearer.
        assert!((straight(&limits, 0.2, Some(1.0), Some(0.0)) - 2.0).abs() < 1e-12);
    }
}
