//! The free space of a problem: obstacles, clearance and bounds, adjusted so that start and goal
//! are free.

use geometry::shape::{Aabb, Contact, Convex};
use nalgebra::{Point2, Vector2};
use navigation::tangent_graph::{ShortestPath, shortest_once};
use planner_view::free_space::FreeSpace;

use crate::path_points::PathPoint;
use crate::plan::PlanError;
use trajectory_problem::{Problem, ProblemError};

/// Cells along the longer side of the field of the exact geometry. Few: a problem needs some
/// hundred queries, and building the field costs as much as they do.
const CELLS: f64 = 16.0;
/// Depth (m) of a goal in a grown obstacle or beyond the bounds that counts as rounding.
const GOAL_TOLERANCE: f64 = 1e-6;
/// Distance (m) by which an obstacle is cut back beyond a start that lies in it, to cover rounding.
const START_MARGIN: f64 = 1e-9;
/// Radius (m) of discs that have none: the exact geometry requires pieces with an inside.
const MIN_RADIUS: f64 = 1e-7;

/// The obstacle field of a problem.
#[derive(Debug, Clone)]
pub struct ObstacleField {
    /// The problem's obstacles; a grown obstacle that contains the start is cut back until the
    /// start is on its border.
    pub obstacles: Vec<Convex>,
    /// Allowed positions of the robot's centre: the problem's bounds, and the start.
    pub bounds: Aabb,
    /// Minimum distance (m) of the robot's centre from obstacles.
    pub clearance: f64,
    start: Point2<f64>,
    goal: Point2<f64>,
}

impl ObstacleField {
    /// Creates the obstacle field of a valid problem ([`Problem::validate`]).
    ///
    /// # Errors
    /// [`ProblemError`] if the start is deeper in an obstacle than tolerated, or the goal in one or
    /// beyond the bounds.
    pub fn new(problem: &Problem) -> Result<Self, ProblemError> {
        let start = problem.start.position();
        let goal = problem.goal;
        let mut obstacle_field = Self {
            obstacles: problem.obstacles.iter().map(with_inside).collect(),
            bounds: problem.bounds,
            clearance: problem.clearance,
            start,
            goal,
        };
        obstacle_field.admit_start(problem.start_tolerance)?;
        obstacle_field.check_goal()?;
        Ok(obstacle_field)
    }

    fn admit_start(&mut self, tolerance: f64) -> Result<(), ProblemError> {
        let start = self.start;
        let refused = |what: &str, depth: f64| ProblemError {
            field: "start".to_owned(),
            value: format!("({}, {})", start.x, start.y),
            expected: format!("a place no more than {tolerance} {what}; it is {depth:.4}"),
        };
        let outside = beyond(&self.bounds, start);
        if outside > tolerance {
            return Err(refused("beyond the bounds", outside));
        }
        let bounds = &mut self.bounds;
        bounds.min = bounds.min.coords.inf(&start.coords).into();
        bounds.max = bounds.max.coords.sup(&start.coords).into();
        for (i, obstacle) in self.obstacles.iter_mut().enumerate() {
            let contact = obstacle.contact(start);
            let depth = self.clearance - contact.distance;
            if depth <= 0.0 {
                continue;
            }
            let what = format!("inside obstacles[{i}], grown by the clearance");
            if depth > tolerance {
                return Err(refused(&what, depth));
            }
            *obstacle = cut_back(obstacle, start, &contact, self.clearance)
                .ok_or_else(|| refused(&what, depth))?;
        }
        Ok(())
    }

    fn check_goal(&self) -> Result<(), ProblemError> {
        let goal = self.goal;
        let refused = |expected: String| ProblemError {
            field: "goal".to_owned(),
            value: format!("({}, {})", goal.x, goal.y),
            expected,
        };
        if beyond(&self.bounds, goal) > GOAL_TOLERANCE {
            let Aabb { min, max } = self.bounds;
            return Err(refused(format!(
                "a place within the bounds, x in {}…{} and y in {}…{}",
                min.x, max.x, min.y, max.y
            )));
        }
        for (i, obstacle) in self.obstacles.iter().enumerate() {
            let distance = obstacle.contact(goal).distance;
            if distance < self.clearance - GOAL_TOLERANCE {
                return Err(refused(format!(
                    "a place at least {} from every obstacle; obstacles[{i}] is {distance:.4} \
                     away",
                    self.clearance
                )));
            }
        }
        Ok(())
    }

    /// The space in which the robot's centre moves as a disc of radius [`Self::clearance`].
    fn space(&self) -> Result<FreeSpace, PlanError> {
        // The bounds are for the centre; the disc may reach beyond.
        let margin = Vector2::repeat(self.clearance);
        let bounds = Aabb {
            min: self.bounds.min - margin,
            max: self.bounds.max + margin,
        };
        let size = bounds.max - bounds.min;
        let cell = size.x.max(size.y) / CELLS;
        FreeSpace::new(self.obstacles.clone(), bounds, cell).map_err(|e| {
            let value = format!("{bounds:?}");
            PlanError::Invalid(ProblemError {
                field: "bounds".to_owned(),
                value,
                expected: e.to_string(),
            })
        })
    }

    /// Minimum radius (m) of the grown obstacles; of polygons, the clearance. Infinite without
    /// obstacles.
    pub fn smallest(&self) -> f64 {
        let radius = |obstacle: &Convex| match obstacle {
            Convex::Disc { radius, .. } => *radius,
            _ => 0.0,
        };
        let radii = self.obstacles.iter().map(radius);
        self.clearance + radii.fold(f64::INFINITY, f64::min)
    }

    /// Largest depth (m) of a path in each grown obstacle that it is in, by index.
    pub fn depths(&self, points: &[PathPoint]) -> Vec<(usize, f64)> {
        let mut found = Vec::new();
        for (index, obstacle) in self.obstacles.iter().enumerate() {
            let mut least = f64::INFINITY;
            let mut i = 0;
            while i < points.len() {
                let distance = obstacle.contact(points[i].at).distance - self.clearance;
                least = least.min(distance);
                // Distances change by no more than the path length: no deep point lies closer than
                // this.
                let reach = points[i].s + distance;
                i += 1;
                i += points[i..].partition_point(|p| p.s < reach);
            }
            if least < 0.0 {
                found.push((index, -least));
            }
        }
        found
    }

    /// The obstacle field as exact geometry.
    ///
    /// # Errors
    /// [`PlanError::Invalid`] for bounds that are too thin for a search.
    pub fn exact(&self) -> Result<ExactObstacleField, PlanError> {
        Ok(ExactObstacleField {
            space: self.space()?,
            clearance: self.clearance,
        })
    }
}

/// The obstacle field as exact geometry, with an index.
#[derive(Debug, Clone)]
pub struct ExactObstacleField {
    /// The pieces.
    pub space: FreeSpace,
    /// Minimum distance (m) of the robot's centre from them.
    pub clearance: f64,
}

impl ExactObstacleField {
    /// The shortest path between two points (m).
    ///
    /// # Errors
    /// [`PlanError::NoPath`] if there is none; [`PlanError::Invalid`] if there are too many
    /// obstacles to decide.
    pub fn shortest(&self, from: Point2<f64>, to: Point2<f64>) -> Result<ShortestPath, PlanError> {
        shortest_once(&self.space, self.clearance, from, to)
            .map_err(|e| {
                PlanError::Invalid(ProblemError {
                    field: "obstacles".to_owned(),
                    value: format!("a field of {} pieces", self.space.shapes().parts().len()),
                    expected: format!("one in which the search stays within its limits: {e}"),
                })
            })?
            .ok_or(PlanError::NoPath)
    }
}

/// Distance (m) of a point beyond the bounds; 0 within.
fn beyond(bounds: &Aabb, p: Point2<f64>) -> f64 {
    let low = bounds.min - p;
    let high = p - bounds.max;
    [low.x, low.y, high.x, high.y]
        .into_iter()
        .fold(0.0, f64::max)
}

fn with_inside(obstacle: &Convex) -> Convex {
    match obstacle {
        Convex::Disc { center, radius } => Convex::disc(*center, radius.max(MIN_RADIUS)),
        other => other.clone(),
    }
}

/// An obstacle without the part that is nearer to `p` than `clearance` (m): a smaller disc, or the
/// polygon cut along a line; `None` if nothing would be left. The line is perpendicular to the
/// direction to the nearest surface and `clearance` away, so that everything behind it is, too.
fn cut_back(
    obstacle: &Convex,
    p: Point2<f64>,
    contact: &Contact,
    clearance: f64,
) -> Option<Convex> {
    if let Convex::Disc { center, radius } = obstacle {
        let radius = radius - (clearance - contact.distance) - START_MARGIN;
        return (radius > 0.0).then(|| Convex::disc(*center, radius));
    }
    let line = p - contact.normal * (clearance + START_MARGIN);
    let height = |corner: Point2<f64>| (corner - line).dot(&contact.normal);
    let corners = obstacle.corners();
    let mut left = Vec::with_capacity(corners.len() + 1);
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (ha, hb) = (height(a), height(b));
        if ha <= 0.0 {
            left.push(a);
        }
        if (ha < 0.0 && hb > 0.0) || (ha > 0.0 && hb < 0.0) {
            left.push(a + (b - a) * (ha / (ha - hb)));
        }
    }
    (left.len() >= 3).then(|| Convex::polygon(&left))
}
