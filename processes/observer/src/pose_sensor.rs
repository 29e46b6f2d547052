//! Pose sensor of an observer: its viewpoint and its noise.

use geometry::math;
use geometry::pose::Pose2;
use nalgebra::Point2;
use rand_chacha::ChaCha8Rng;
use tracking::params::SensorParams;
use tracking::sighting::gaussian_pair;
use tracking::space::Space;
use tracking::watch::Watch;

use crate::moment::MeasuredPose;
use crate::params::PoseSensorParams;

/// Visibility below which a robot is not seen.
const MIN_VISIBILITY: f64 = 1e-3;

/// Viewpoints at one tick.
#[derive(Debug, Clone)]
pub struct PoseSensor {
    params: PoseSensorParams,
    /// `true` if lines of sight matter.
    limited: bool,
    watch: Watch,
}

impl PoseSensor {
    /// Returns a sensor. If `limited`, it has viewpoints; otherwise it sees everything always.
    pub fn new(params: &PoseSensorParams, limited: bool) -> Self {
        let sensor = SensorParams {
            range: params.range,
            ..SensorParams::default()
        };
        Self {
            params: params.clone(),
            limited,
            watch: Watch::new(&sensor),
        }
    }

    /// Moves the observers to these places (m).
    pub fn set(&mut self, space: &Space, places: impl IntoIterator<Item = Point2<f64>>) {
        let poses: Vec<Pose2> = places
            .into_iter()
            .map(|place| Pose2::new(place.x, place.y, 0.0))
            .collect();
        self.watch.set(space.field(), &poses);
    }

    /// Returns the observers, for the particle filter.
    pub fn watch(&self) -> &Watch {
        &self.watch
    }

    /// Observes a robot: returns its visibility (0…1), and the measurement if it is sufficient. It
    /// draws the same number of random values in both cases.
    pub fn look(
        &self,
        space: &Space,
        truth: Pose2,
        rng: &mut ChaCha8Rng,
    ) -> (f64, Option<MeasuredPose>) {
        let ((x, y), (turn, _)) = (gaussian_pair(rng), gaussian_pair(rng));
        let visibility = if self.limited {
            self.watch
                .best(space.field(), truth.position())
                .map_or(0.0, |(visibility, _)| visibility)
        } else {
            1.0
        };
        let (sigma, heading_sigma) = (self.params.noise, self.params.heading_noise);
        let seen = MeasuredPose {
            position: Point2::new(truth.x + sigma * x, truth.y + sigma * y),
            heading: math::wrap_angle(truth.theta + heading_sigma * turn),
            sigma,
            heading_sigma,
        };
        let well = visibility >= MIN_VISIBILITY;
        (visibility, well.then_some(seen))
    }
}
