//! Potential fields: attraction, repulsion, obstacles, and measures against local minima.
//!
//! Each part gives a velocity (m/s) at a point; a planner adds them up and limits the sum
//! ([`compose`]). The magnitude is an urgency rather than a speed: parts of a few m/s compete, and
//! feedback linearisation keeps the direction of the sum and any speed that the robot can reach.

mod attraction;
mod bodies;
mod obstacle;
mod perturbation;
mod repulsion;

pub use attraction::{Goal, attraction};
pub use bodies::{Body, slide_around_bodies};
pub use obstacle::{ObstacleParams, obstacle, slide_along_obstacles};
pub use perturbation::{Perturbation, PerturbationParams};
pub use repulsion::{Falloff, RepulsionParams, Repulsor, repulsion};

use nalgebra::{Point2, Vector2};

use planner_view::map::PlannerMap;
use planner_view::view::RobotView;

/// Magnitude of a saturated attraction, and the limit of the sum (m/s) (the paper's experiments).
pub const FIELD_SPEED: f64 = 2.0;

/// The vector, shortened to a magnitude of at most `cap`; zero if it is not finite.
pub fn capped(field: Vector2<f64>, cap: f64) -> Vector2<f64> {
    let norm = field.norm();
    if !norm.is_finite() {
        Vector2::zeros()
    } else if norm > cap {
        field * (cap / norm)
    } else {
        field
    }
}

/// The field of a robot at a point near its centre: the sum of a planner's parts without the part
/// that would drive the robot into `bodies` and obstacles, limited to [`FIELD_SPEED`].
///
/// `body_guard` is the gap to another body (m) at which the robot begins to turn aside, 0 to
/// disable.
pub fn compose(
    map: &PlannerMap,
    own: &RobotView,
    at: Point2<f64>,
    sum: Vector2<f64>,
    bodies: impl IntoIterator<Item = Body>,
    body_guard: f64,
    obstacle: &ObstacleParams,
) -> Vector2<f64> {
    let here = own.pose.position();
    let around = slide_around_bodies(map, here, own.radius, sum, bodies, body_guard);
    let along = slide_along_obstacles(map, at, own.radius, around, obstacle.guard);
    capped(along, FIELD_SPEED)
}
