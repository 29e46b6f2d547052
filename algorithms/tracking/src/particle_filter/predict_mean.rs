//! Prediction of the mean.

use nalgebra::Point2;

use super::ParticleFilter;
use super::predict::Motion;
use crate::space::Space;

/// Maximum step of the motion (s): short against the time in which hypotheses straighten.
const STEP: f64 = 0.1;

/// Maximum number of steps; longer horizons use longer steps.
const MAX_STEPS: f64 = 1000.0;

impl ParticleFilter {
    /// The mean of the particles `horizon` (s) from now, without sightings until then. Each
    /// particle moves by its motion model without noise, and stops in front of an obstacle.
    ///
    /// A horizon that is not positive and finite gives the current mean.
    pub fn mean_after(&self, space: &Space, horizon: f64) -> Point2<f64> {
        let mut cloud = self.particles.clone();
        let n = cloud.len();
        if horizon > 0.0 && horizon.is_finite() {
            let steps = (horizon / STEP).ceil().clamp(1.0, MAX_STEPS);
            let motion = Motion::new(&self.params, self.limits, horizon / steps).quiet();
            let silence = vec![0; 4 * n];
            let (mut x, mut y) = (Vec::new(), Vec::new());
            for _ in 0..steps as usize {
                x.clone_from(&cloud.x);
                y.clone_from(&cloud.y);
                motion.apply(cloud.stretch(0..n), &silence);
                for i in 0..n {
                    if space.valid_at(space.place_of(cloud.x[i], cloud.y[i])) == 0 {
                        (cloud.x[i], cloud.y[i]) = (x[i], y[i]);
                    }
                }
            }
        }
        let (mut sum, mut mean) = (0.0, [0.0; 2]);
        for (i, &weight) in self.weights.iter().enumerate() {
            let weight = f64::from(weight);
            sum += weight;
            mean[0] += weight * f64::from(cloud.x[i]);
            mean[1] += weight * f64::from(cloud.y[i]);
        }
        Point2::from(mean.map(|m| m / sum))
    }
}
