//! Obstacles of a problem and the shortest path among them, common to all methods; checked trajectories.

use crate::drive::trajectory_builder::Trajectory;
use crate::guide::Guide;
use crate::obstacle_field::{ExactObstacleField, ObstacleField};
use crate::path_points;
use crate::plan::PlanError;
use crate::validity_check;
use trajectory_problem::Problem;

/// The obstacles of a problem, and the shortest path among them.
pub struct Course {
    /// The obstacles.
    pub obstacle_field: ObstacleField,
    /// The same as exact geometry.
    pub exact: ExactObstacleField,
    /// Length of the shortest path (m).
    pub shortest: f64,
    /// The shortest path, if start and goal are not the same point.
    pub guide: Option<Guide>,
}

impl Course {
    /// Computes it.
    ///
    /// # Errors
    /// [`PlanError`] if an end is not free or no path leads to the goal.
    pub fn new(problem: &Problem) -> Result<Self, PlanError> {
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

/// A trajectory that has passed the check.
pub struct CheckedTrajectory {
    /// The trajectory.
    pub trajectory: Trajectory,
    /// Minimum distance of the path from grown obstacles (m).
    pub min_clearance: f64,
    /// Number of control points of its curve; 0 without one.
    pub control_points: usize,
}

impl CheckedTrajectory {
    /// Checks a trajectory; `None` if it does not pass.
    pub fn new(
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
}
