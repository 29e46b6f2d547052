//! The goal as the robot sees it.

use geometry::pose::Pose2;
use nalgebra::{Point2, Vector2};

use super::run::Run;
use super::surroundings::{DIRECTIONS, Surroundings, nearest_direction};

/// The goal relative to the scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    pub(super) goal: Point2<f64>,
    /// Distance from the goal at which it is reached (m).
    pub(super) tolerance: f64,
    /// d(x, goal) (m).
    pub(super) distance: f64,
    /// Unit vector towards the goal.
    pub(super) towards: Vector2<f64>,
    /// Unit vector along the robot's heading.
    pub(super) forward: Vector2<f64>,
    /// Free length of the straight line to the goal (m).
    pub(super) free: f64,
    /// `true` if the line is free as far as visible, or to the goal.
    pub(super) is_open: bool,
    /// `true` if the line is free to the goal.
    pub(super) is_reachable: bool,
}

impl Sight {
    pub(super) fn new(
        view: &Surroundings,
        pose: &Pose2,
        goal: Point2<f64>,
        tolerance: f64,
    ) -> Self {
        let offset = goal - view.here;
        let distance = offset.norm();
        let towards = if distance > 0.0 {
            offset / distance
        } else {
            Vector2::x()
        };
        let free = view.free_towards(towards);
        let needed = distance - tolerance;
        Self {
            goal,
            tolerance,
            distance,
            towards,
            forward: pose.forward(),
            free,
            is_open: free >= needed.min(view.reach),
            is_reachable: free >= needed,
        }
    }

    /// The boundary that blocks the line.
    pub(super) fn blocking(&self, view: &Surroundings, jump: f64) -> Option<Run> {
        let k = nearest_direction(self.towards) + DIRECTIONS;
        // Directions are discrete: a neighbouring one may be the blocked one.
        [k, k + 1, k - 1]
            .into_iter()
            .find_map(|k| Run::around(view, k, jump))
    }
}
