//! Common interface of all planners of sub-goals.

use geometry::shape::Aabb;
use nalgebra::Point2;
use planner_view::waypoint::Waypoint;

/// A sub-goal, and the free rectangle of the straight leg to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// The sub-goal.
    pub waypoint: Waypoint,
    /// A rectangle of free space for the robot's centre that contains the leg from the previous
    /// goal (or the start) to this one (m); `None` if the planner guarantees only the leg itself.
    pub within: Option<Aabb>,
}

/// A planner of sub-goals.
pub trait GoalSource {
    /// The next sub-goal of a robot whose leg will begin at `from` (m) (the previous sub-goal, or
    /// the robot's position); `None` at the end of the plan.
    ///
    /// The straight leg from the previous goal to this one is free of all obstacles known to the
    /// workplace.
    fn next_goal(&mut self, from: Point2<f64>) -> Option<Goal>;

    /// Reports that the robot has driven straight from one place to another (m), whatever its goal.
    /// Planners that depend on the real coverage may use it; others ignore it.
    fn driven(&mut self, from: Point2<f64>, to: Point2<f64>) {
        let _ = (from, to);
    }
}
