//! What all planners of sub-goals have in common.

use geometry::shape::Aabb;
use nalgebra::Point2;
use planner_view::waypoint::Waypoint;

/// A sub-goal, and where the straight leg to it runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// The sub-goal.
    pub waypoint: Waypoint,
    /// A rectangle of free space for the robot's centre that contains the leg from the goal before
    /// (or the start) to this one (m); `None` if the planner vouches for the leg alone.
    pub within: Option<Aabb>,
}

/// A planner of sub-goals.
pub trait GoalSource {
    /// The next sub-goal of a robot whose leg will begin at `from` (m) (the sub-goal before, or
    /// where the robot stands); `None` when there is nothing left to do.
    ///
    /// The straight leg from the goal before to this one is free of obstacles as far as the
    /// workplace knows them.
    fn next_goal(&mut self, from: Point2<f64>) -> Option<Goal>;

    /// Takes note that the robot has driven straight from one place to another (m), whatever it was
    /// sent to. Planners that go by what has been covered may use it; the rest do without.
    fn driven(&mut self, from: Point2<f64>, to: Point2<f64>) {
        let _ = (from, to);
    }
}
