//! The corridors of a problem: the ways around its obstacles that may hold the fastest trajectory.
//!
//! A corridor is a homotopy class, with its shortest path. A trajectory in it is no shorter than that
//! path, which bounds its duration; the turns that the path requires show which corridor is tried
//! first.

use navigation::tangent_graph::{ShortestPath, k_shortest_classes};

use crate::guesses;
use crate::lower_bound::lower_bound;
use crate::obstacle_field::ExactObstacleField;
use crate::plan::PlanError;
use trajectory_problem::{Problem, ProblemError};

/// Number of corridors by length, per corridor by time.
const SPARE: usize = 3;

/// A corridor.
#[derive(Debug, Clone, PartialEq)]
pub struct Corridor {
    /// Its shortest path.
    pub path: ShortestPath,
    /// Lower bound (s) on the duration of every trajectory in it.
    pub lower_bound: f64,
    /// Duration (s) of driving its path at full speed, with turns on the spot or words at both ends.
    pub estimate: f64,
}

/// At most `k` corridors in which a trajectory may take no longer than `most` (s), in order of their
/// estimates (of equal ones, the shorter first).
///
/// # Errors
/// [`PlanError::Invalid`] if there are too many obstacles to decide.
pub fn corridors(
    problem: &Problem,
    field: &ExactObstacleField,
    k: usize,
    most: f64,
) -> Result<Vec<Corridor>, PlanError> {
    let (from, to) = (problem.start.position(), problem.goal);
    let longest = most * problem.limits.top_speed();
    let count = k.saturating_mul(SPARE);
    let paths = k_shortest_classes(&field.space, field.clearance, from, to, count, longest);
    let paths = paths.map_err(|error| ProblemError {
        field: "obstacles".to_owned(),
        value: format!("a field of {} pieces", field.space.shapes().parts().len()),
        expected: format!("one in which the search stays within its limits: {error}"),
    })?;
    let mut corridors: Vec<Corridor> = Vec::new();
    // The shorter come first.
    for path in paths {
        let lower_bound = lower_bound(problem, path.length);
        let known = corridors.get(k.wrapping_sub(1));
        if lower_bound > most || known.is_some_and(|known| known.estimate <= lower_bound) {
            continue;
        }
        let estimate = lower_bound.max(guesses::time_along(problem, &path.legs));
        let at = corridors.partition_point(|known| known.estimate <= estimate);
        let corridor = Corridor {
            path,
            lower_bound,
            estimate,
        };
        corridors.insert(at, corridor);
    }
    corridors.truncate(k);
    Ok(corridors)
}

#[cfg(test)]
mod tests {
    use geometry::pose::Pose2;
    use geometry::shape::{Aabb, Convex};
    use nalgebra::Point2;

    use super::*;
    use crate::RobotLimits;
    use crate::obstacle_field::ObstacleField;

    /// A disc on the way, a little to the left; the robot looks to the left.
    fn problem() -> Problem {
        Problem {
            start: Pose2::new(0.0, 0.0, 0.8),
            start_speed: None,
            start_turn_rate: None,
            goal: Point2::new(4.0, 0.0),
            goal_heading: None,
            goal_speed: None,
            limits: RobotLimits::simple(0.15, 0.3).forwards(),
            obstacles: vec![Convex::disc(Point2::new(2.0, 0.02), 0.5)],
            clearance: 0.1,
            bounds: Aabb {
                min: Point2::new(-3.0, -3.0),
                max: Point2::new(7.0, 3.0),
            },
            start_tolerance: 5e-3,
        }
    }

    fn found(problem: &Problem, k: usize, most: f64) -> Vec<Corridor> {
        let field = ObstacleField::new(problem).unwrap().exact().unwrap();
        corridors(problem, &field, k, most).unwrap()
    }

    #[test]
    fn a_longer_corridor_that_saves_a_turn_comes_first() {
        let all = found(&problem(), 4, 1e3);
        assert_eq!(all.len(), 2);
        assert!(all[0].path.length > all[1].path.length);
        assert!(all[0].estimate < all[1].estimate);
        for corridor in &all {
            assert!(corridor.lower_bound <= corridor.estimate);
            assert!(corridor.lower_bound >= corridor.path.length / 0.15);
        }
    }

    #[test]
    fn corridors_that_cannot_be_faster_are_left_out() {
        let all = found(&problem(), 4, 1e3);
        let most = 0.5 * (all[0].lower_bound + all[1].lower_bound);
        assert_eq!(found(&problem(), 4, most).len(), 1);
        assert_eq!(found(&problem(), 1, 1e3).len(), 1);
        assert!(found(&problem(), 4, 1.0).is_empty());
    }
}
