//! Weights of a seen opponent, and the collapse of the belief, as in the program that the authors of
//! the chasing-game paper published.

use geometry::math;

use super::SNAP_BELOW;
use super::cloud::Cloud;
use crate::sighting::Measurement;
use crate::space::Space;

/// Logarithm of the smallest positive double: smaller weights are 0.
const UNDERFLOW: f64 = -745.0;

/// Sets the weights to N(x)·N(y)/(1 + |Δheading|), up to a common factor, and to 1 for a measurement
/// that moves all particles to it. Particles in obstacles or outside the map get 0.
///
/// A common factor makes the largest weight 1, so that a measurement far away from all particles
/// still tells them apart, as in double precision.
pub fn weigh(space: &Space, particles: &Cloud, m: &Measurement, weights: &mut [f32]) {
    let log_weight = |i: usize| {
        let (x, y) = (particles.x[i], particles.y[i]);
        if space.valid_at(space.place_of(x, y)) == 0 {
            return f64::NEG_INFINITY;
        }
        if m.sigma < SNAP_BELOW {
            return 0.0;
        }
        let (dx, dy) = (f64::from(x) - m.position.x, f64::from(y) - m.position.y);
        let turn = m.heading.map_or(0.0, |(theta, _)| {
            math::angle_difference(f64::from(particles.heading[i]), theta).abs()
        });
        -(dx * dx + dy * dy) / (2.0 * m.sigma * m.sigma) - math::ln(1.0 + turn)
    };
    let largest = (0..particles.len())
        .map(log_weight)
        .fold(f64::NEG_INFINITY, f64::max);
    for (i, weight) in weights.iter_mut().enumerate() {
        let log = log_weight(i);
        *weight = if log > UNDERFLOW {
            math::exp(log - largest) as f32
        } else {
            0.0
        };
    }
}

/// Replaces all particles by copies of the first one. Where that is in an obstacle, the belief stays
/// without weight until it jumps out.
pub fn collapse(particles: &mut Cloud) {
    for array in [
        &mut particles.x,
        &mut particles.y,
        &mut particles.heading,
        &mut particles.v,
        &mut particles.omega,
    ] {
        if let Some(&first) = array.first() {
            array.fill(first);
        }
    }
}
