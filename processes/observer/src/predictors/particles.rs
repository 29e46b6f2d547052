//! The particle filter of the chasing game, with its particles moved ahead.

use geometry::pose::Pose2;
use nalgebra::Point2;
use rand_chacha::ChaCha8Rng;
use tracking::params::FilterParams;
use tracking::particle_filter::{MotionLimits, ParticleFilter};
use tracking::sighting::{Measurement, Sighting};
use tracking::space::Space;

use super::Predictor;
use crate::moment::Moment;

/// Belief about a robot, and its mean as prediction.
#[derive(Debug, Clone)]
pub struct Particles {
    filter: ParticleFilter,
}

impl Particles {
    /// Returns a predictor for a robot with these limits that starts at this pose, if it is known; `params` must
    /// be valid.
    pub fn new(
        params: &FilterParams,
        limits: MotionLimits,
        start: Option<Pose2>,
        space: &Space,
        rng: ChaCha8Rng,
    ) -> Self {
        Self {
            filter: ParticleFilter::new(params, limits, start, space, rng),
        }
    }
}

impl Predictor for Particles {
    fn observe(&mut self, moment: &Moment<'_>) {
        let look = &moment.look;
        let measurement = look.seen.map(|seen| Measurement {
            position: seen.position,
            sigma: seen.sigma,
            heading: Some((seen.heading, seen.heading_sigma)),
        });
        let sighting = Sighting {
            visibility: look.visibility,
            observer: None,
            measurement,
        };
        self.filter
            .update(moment.space, moment.watch, &sighting, look.dt);
    }

    fn predict(&self, horizon: f64, moment: &Moment<'_>) -> Option<Point2<f64>> {
        Some(self.filter.mean_after(moment.space, horizon))
    }
}
