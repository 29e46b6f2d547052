//! Lower bounds on the lengths of paths.

use std::sync::Arc;

use nalgebra::Point2;
use navigation::tangent_graph::Towards;

/// Lower bounds of the distance from the start to a place, and from there to the nearest goal.
///
/// Straight lines bound every path from below. The shortest path among the obstacles, where it is
/// known, is a better bound of paths from a place to a goal.
#[derive(Debug, Clone, Default)]
pub struct Bound {
    start: Point2<f64>,
    goals: Vec<Point2<f64>>,
    along_streets: Vec<Arc<Towards>>,
}

impl Bound {
    /// Bounds by straight lines.
    pub fn straight(start: Point2<f64>, goals: &[Point2<f64>]) -> Self {
        Self {
            start,
            goals: goals.to_vec(),
            along_streets: Vec::new(),
        }
    }

    /// Returns bounds by the shortest paths to these goals for a robot that is no larger than the
    /// planning one.
    pub fn along_streets(start: Point2<f64>, goals: &[Arc<Towards>]) -> Self {
        Self {
            start,
            goals: goals.iter().map(|goal| goal.goal()).collect(),
            along_streets: goals.to_vec(),
        }
    }

    /// Returns the minimum length of a path from the start to a place (m).
    pub fn from_start(&self, p: Point2<f64>) -> f64 {
        (p - self.start).norm()
    }

    /// Returns the minimum length of a path from a place to a goal (m); infinite without a goal.
    pub fn to_goal(&self, p: Point2<f64>) -> f64 {
        if self.along_streets.is_empty() {
            return self.straight_to_goal(p);
        }
        self.along_streets
            .iter()
            .map(|goal| goal.lower_bound(p))
            .fold(f64::INFINITY, f64::min)
    }

    fn straight_to_goal(&self, p: Point2<f64>) -> f64 {
        self.goals
            .iter()
            .map(|goal| (goal - p).norm())
            .fold(f64::INFINITY, f64::min)
    }

    /// Returns `true` if a path over this place could be shorter than `best` (m).
    pub fn can_improve(&self, p: Point2<f64>, best: f64) -> bool {
        let from_start = self.from_start(p);
        // The cheap test first.
        from_start + self.straight_to_goal(p) < best && from_start + self.to_goal(p) < best
    }
}
