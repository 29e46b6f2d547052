//! Potential fields: attraction, repulsion, obstacles, and what keeps a robot out of local minima.
//!
//! Each part gives a velocity [m/s] at a point; a planner adds them up and caps the sum
//! ([`capped`]). The magnitude is an urgency more than a speed: parts of a few m/s compete, and
//! feedback linearisation keeps the sum's direction and whatever speed the robot can do.

mod attraction;
mod bodies;
mod obstacle;
mod perturbation;
mod repulsion;

pub use attraction::{AttractionParams, Goal, attraction};
pub use bodies::{Body, slide_around_bodies};
pub use obstacle::{ObstacleGradient, ObstacleParams, obstacle, slide_along_obstacles};
pub use perturbation::{Perturbation, PerturbationParams};
pub use repulsion::{Falloff, RepulsionParams, Repulsor, repulsion};

use nalgebra::Vector2;

/// Magnitude of a fully grown attraction, and the cap of the sum [m/s] (the paper's experiments).
pub const PAPER_FIELD_SPEED: f64 = 2.0;

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
