//! The site that a coverage planner plans for.

use crate::decomposition::{Decomposition, DecompositionError};
use crate::workplace::{Workplace, WorkplaceError};
use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;

use crate::sub_goals::params::FollowParams;

/// The workplace of a robot.
#[derive(Debug, Clone)]
pub struct Site {
    /// The workplace, for the robot's radius and margin.
    pub workplace: Workplace,
    /// Its free space.
    pub decomposition: Decomposition,
    /// Position of the robot (m), or the nearest free place.
    pub start: Point2<f64>,
}

impl Site {
    /// Creates the workplace within `bounds` (m) among obstacles, for a robot of this radius (m) at
    /// `here`.
    ///
    /// # Errors
    /// The error text names the invalid value and the remedy.
    pub fn new(
        bounds: Aabb,
        obstacles: &[Convex],
        radius: f64,
        follow: &FollowParams,
        here: Point2<f64>,
    ) -> Result<Self, String> {
        let workplace =
            Workplace::from_parts(bounds, radius + follow.margin, obstacles, follow.tolerance)
                .map_err(|e| match e {
                    WorkplaceError::Radius { limit, .. } => format!(
                        "`follow.margin` is {} m and the robot's radius {radius} m, but together \
                         they must be below {limit} m, half the shorter side of the workplace: \
                         enlarge it, keep less margin or take a smaller robot",
                        follow.margin
                    ),
                    e => e.to_string(),
                })?;
        let decomposition = Decomposition::new(&workplace).map_err(|e| match e {
            DecompositionError::NoFreeSpace { .. } => format!(
                "`follow.margin` is {} m and the robot's radius {radius} m: the obstacles, grown by \
                 both, leave no free space; keep less margin, take fewer or smaller obstacles, a \
                 smaller robot, or a smaller `follow.tolerance`",
                follow.margin
            ),
            e @ DecompositionError::TooManyCells { .. } => e.to_string(),
        })?;
        let nearest = decomposition
            .nearest_rectangle(here)
            .and_then(|(nearest, _)| decomposition.rectangles().get(nearest))
            .ok_or("the robot is nowhere")?;
        let start = here.sup(&nearest.min).inf(&nearest.max);
        Ok(Self {
            workplace,
            decomposition,
            start,
        })
    }
}
