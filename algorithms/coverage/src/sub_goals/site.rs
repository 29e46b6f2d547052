//! The site that a coverage planner plans for.

use crate::decomposition::{Decomposition, DecompositionError, Place};
use crate::workplace::{Workplace, WorkplaceError};
use geometry::shape::{Aabb, Convex};
use nalgebra::Point2;
use thiserror::Error;

use crate::sub_goals::params::FollowParams;

/// Reason why there is no site.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SiteError {
    /// The robot with its margin is too large for the workplace.
    #[error(
        "`follow.margin` is {margin} m and the robot's radius {radius} m: expected a sum below \
         {limit} m, half the shorter side of the workplace; enlarge it, keep less margin or take a \
         smaller robot"
    )]
    TooNarrow {
        /// Margin (m).
        margin: f64,
        /// Radius of the robot (m).
        radius: f64,
        /// Upper limit of their sum (m).
        limit: f64,
    },
    /// The grown obstacles leave nothing.
    #[error(
        "`follow.margin` is {margin} m and the robot's radius {radius} m: the obstacles, grown by \
         both, leave no free space; keep less margin, take fewer or smaller obstacles, a \
         smaller robot, or a smaller `follow.tolerance`"
    )]
    NoFreeSpace {
        /// Margin (m).
        margin: f64,
        /// Radius of the robot (m).
        radius: f64,
    },
    /// Another fault of the workplace.
    #[error(transparent)]
    Workplace(WorkplaceError),
    /// Too many cells.
    #[error(transparent)]
    Decomposition(DecompositionError),
    /// The position of the robot is no number.
    #[error("the robot is nowhere")]
    Nowhere,
}

impl SiteError {
    /// Returns the parameter to change, by its dotted path; empty if none can help.
    pub fn field(&self) -> &'static str {
        match self {
            Self::TooNarrow { .. } | Self::NoFreeSpace { .. } => "follow.margin",
            Self::Workplace(
                WorkplaceError::Tolerance { .. } | WorkplaceError::TooManyRectangles { .. },
            ) => "follow.tolerance",
            Self::Workplace(_) | Self::Decomposition(_) | Self::Nowhere => "",
        }
    }
}

/// The workplace of a robot.
#[derive(Debug, Clone)]
pub struct Site {
    /// The workplace, for the robot's radius and margin.
    pub workplace: Workplace,
    /// Its free space.
    pub decomposition: Decomposition,
    /// Position of the robot (m), or the nearest free place.
    pub start: Point2<f64>,
    /// Number of the part that the robot covers, from 0; 0 of an undivided workplace.
    pub part: usize,
}

impl Site {
    /// Creates the workplace within `bounds` (m) among obstacles, for a robot of this radius (m) at
    /// `here`.
    ///
    /// # Errors
    /// [`SiteError`] names the invalid value and the remedy.
    pub fn new(
        bounds: Aabb,
        obstacles: &[Convex],
        radius: f64,
        follow: &FollowParams,
        here: Point2<f64>,
    ) -> Result<Self, SiteError> {
        let margin = follow.margin;
        let workplace = Workplace::from_parts(bounds, radius + margin, obstacles, follow.tolerance)
            .map_err(|e| match e {
                WorkplaceError::Radius { limit, .. } => SiteError::TooNarrow {
                    margin,
                    radius,
                    limit,
                },
                e => SiteError::Workplace(e),
            })?;
        let decomposition = Decomposition::new(&workplace).map_err(|e| match e {
            DecompositionError::NoFreeSpace { .. } => SiteError::NoFreeSpace { margin, radius },
            e @ DecompositionError::TooManyCells { .. } => SiteError::Decomposition(e),
        })?;
        let nearest = decomposition
            .nearest_rectangle(here)
            .and_then(|(nearest, _)| decomposition.rectangles().get(nearest))
            .ok_or(SiteError::Nowhere)?;
        let start = here.sup(&nearest.min).inf(&nearest.max);
        Ok(Self {
            workplace,
            decomposition,
            start,
            part: 0,
        })
    }

    /// The same for one robot of a team, by its number `own` in the team ([`Decomposition::divided`]).
    ///
    /// # Errors
    /// [`SiteError`] if the borders are too many.
    pub fn divided(mut self, team: &[Place], own: usize) -> Result<Self, SiteError> {
        let divided = self.decomposition.divided(&self.workplace, team, own);
        (self.decomposition, self.part) = divided.map_err(SiteError::Decomposition)?;
        Ok(self)
    }
}
