//! The belief about one opponent: a particle filter on its pose, speed and turning rate
//! (chasing-game paper, section III.D).
//!
//! Each tick, every particle is moved by its own velocity hypothesis, weighted by the sighting — in
//! one of four cases — and resampled:
//! 1. in an obstacle or outside the map: weight 0;
//! 2. opponent seen with noise σ: Gaussian likelihood (also of the heading if the sensor has it);
//! 3. opponent unseen: (1 − V)^(rate·dt), V the best visibility of the particle;
//! 4. opponent seen with σ below 0.01 m: as case 2 with a width of a fraction of a step, then all
//!    particles take the measured position, and the heading if that was measured as precisely.
//!
//! If no weight is left (or the mean likelihood is below `LOST_BELOW`), the belief is rebuilt:
//! around the measurement if there is one, else uniformly over free space. Unseen space that the
//! opponent can have reached since it was last seen takes precedence over all free space.
//!
//! The published program weighs cases 2 and 4 otherwise and does not rebuild ([`parameters::Fidelity::Published`],
//! module `published`).
//!
//! Random numbers come from one ChaCha8 stream per filter, and every sum has a fixed order: the same
//! inputs give the same bits on every machine.

mod cloud;
mod predict;
mod predict_mean;
mod published;
mod recover;
mod resample;
mod weigh;

use geometry::pose::Pose2;
use nalgebra::Point2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use self::cloud::Cloud;
use self::predict::{Motion, Teleport};
use self::weigh::{SeenLikelihood, UnseenLikelihood};
use crate::belief::{Belief, Particle, moments};
pub use crate::motion_limits::MotionLimits;
use crate::params::FilterParams;
use crate::sighting::{Measurement, Sighting, gaussian_pair};
use crate::space::Space;
use crate::watch::Watch;

/// Rate at which the factor 1 − V of an unseen opponent is applied (1/s): once per tick of the
/// experiments.
const CLEARING_RATE: f64 = 20.0;

/// Noise of a measured position below which all particles take it, and the measured heading if its
/// noise is below this, too (m, rad).
const SNAP_BELOW: f64 = 0.01;

/// Width of the likelihood that is applied before snapping, as a multiple of the distance (angle)
/// covered per tick at the maximum speed (turning rate). It keeps the hypotheses that predicted the
/// measurement; the filter infers headings from them.
const SNAP_WIDTH: f64 = 0.15;

/// Mean likelihood (1 for a perfect fit) below which the belief is rebuilt. A correct belief falls
/// below it by chance with this probability per tick.
const LOST_BELOW: f64 = 1e-4;

/// Distance (m) added to the distance that the opponent can have covered unseen, when the belief is
/// rebuilt around its last seen position.
const RECOVERY_MARGIN: f64 = 0.5;

/// Number of particles per block: all their arrays fit the first-level cache.
const BLOCK: usize = 512;

/// The particle filter of one opponent. See the [module documentation](self).
#[derive(Debug, Clone)]
pub struct ParticleFilter {
    params: FilterParams,
    limits: MotionLimits,
    rng: ChaCha8Rng,
    particles: Cloud,
    /// Weights with mean 1.
    weights: Vec<f32>,
    last_seen: Option<Point2<f64>>,
    /// Time since the opponent was last seen (s).
    unseen_for: f64,
    seen: bool,
    /// `true` until the first update of a filter without a start pose.
    has_no_place: bool,
    effective: f64,
    rebuilt: u64,
    scratch: Scratch,
}

/// Working memory, reused so that a tick does not allocate.
#[derive(Debug, Clone, Default)]
struct Scratch {
    resampled: Cloud,
    starts: Vec<u32>,
    noise: Vec<u8>,
    places: Vec<u32>,
    cells: Vec<u32>,
}

impl ParticleFilter {
    /// Creates a filter with all particles at the opponent's known pose and velocities drawn from its
    /// limits, or, without a pose, uniformly over the free space: the first update confines these to what no
    /// observer sees, or places them at the sighting.
    ///
    /// `params` must be valid ([`parameters::check`](fn@parameters::check)).
    pub fn new(
        params: &FilterParams,
        limits: MotionLimits,
        start: Option<Pose2>,
        space: &Space,
        mut rng: ChaCha8Rng,
    ) -> Self {
        let limits = params.narrowed(limits);
        let mut particles = Cloud::default();
        particles.resize(params.particles.max(1));
        let n = particles.len();
        let mut scratch = Scratch {
            noise: vec![0; 4 * BLOCK],
            ..Scratch::default()
        };
        scratch.places.resize(BLOCK, 0);
        let velocities = velocities(params, limits);
        if let Some(pose) = start {
            let m = Measurement {
                position: pose.position(),
                sigma: 0.0,
                heading: Some((pose.theta, 0.0)),
            };
            recover::around_measurement(&mut particles, space, &m, velocities, &mut rng);
        } else {
            let no_observers = Watch::new(&crate::params::SensorParams::default());
            let cells = &mut scratch.cells;
            recover::over_unseen(
                &mut particles,
                space,
                &no_observers,
                None,
                velocities,
                cells,
                &mut rng,
            );
        }
        Self {
            params: params.clone(),
            limits,
            rng,
            particles,
            weights: vec![1.0; n],
            last_seen: start.map(|pose| pose.position()),
            unseen_for: if start.is_some() { 0.0 } else { f64::INFINITY },
            seen: false,
            has_no_place: start.is_none(),
            effective: n as f64,
            rebuilt: 0,
            scratch,
        }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.particles.len()
    }

    /// Returns `true` if there are no particles (never).
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of times that the belief was rebuilt.
    pub fn rebuilt(&self) -> u64 {
        self.rebuilt
    }

    /// Advances the belief by `dt` (s) (> 0, finite) and applies a sighting.
    ///
    /// `watch` holds the observers of this tick.
    pub fn update(&mut self, space: &Space, watch: &Watch, sighting: &Sighting, dt: f64) {
        self.seen = sighting.is_seen();
        self.unseen_for = if self.seen { 0.0 } else { self.unseen_for + dt };
        if let Some(m) = &sighting.measurement {
            self.last_seen = Some(m.position);
        }
        if core::mem::take(&mut self.has_no_place) {
            self.rebuild(space, watch, sighting.measurement.as_ref());
        }
        self.predict_and_weigh(space, watch, sighting.measurement.as_ref(), dt);

        let (sum, squares) = weigh::totals(&self.weights);
        let is_published = self.params.fidelity.is_published();
        let lost_below = if is_published { 0.0 } else { LOST_BELOW };
        if sum > 0.0 && sum >= lost_below * self.len() as f64 {
            self.effective = sum * sum / squares;
            self.resample(sum);
        } else if is_published {
            published::collapse(&mut self.particles);
            self.weights.fill(1.0);
            self.effective = 1.0;
        } else {
            self.rebuilt += 1;
            self.rebuild(space, watch, sighting.measurement.as_ref());
        }
        if let Some(m) = &sighting.measurement {
            self.snap(m);
            self.scatter(m);
        }
    }

    /// Scatters the particles after a noisy measurement.
    fn scatter(&mut self, m: &Measurement) {
        let deviation = self.params.scatter * m.sigma;
        if m.sigma < SNAP_BELOW || deviation <= 0.0 {
            return;
        }
        for (x, y) in self.particles.x.iter_mut().zip(&mut self.particles.y) {
            let (dx, dy) = gaussian_pair(&mut self.rng);
            *x += (deviation * dx) as f32;
            *y += (deviation * dy) as f32;
        }
    }

    fn predict_and_weigh(
        &mut self,
        space: &Space,
        watch: &Watch,
        measurement: Option<&Measurement>,
        dt: f64,
    ) {
        let motion = Motion::new(&self.params, self.limits, dt);
        let is_published = self.params.fidelity.is_published();
        let seen = measurement.map(|m| {
            let wide = |sigma: f64, step: f64| {
                if sigma < SNAP_BELOW {
                    SNAP_WIDTH * step
                } else {
                    0.0
                }
            };
            let fastest = self.limits.v_max.max(self.limits.v_reverse_max) * dt;
            let heading_sigma = m.heading.map_or(f64::INFINITY, |(_, sigma)| sigma);
            let turn = self.limits.omega_max * dt;
            SeenLikelihood::new(m, wide(m.sigma, fastest), wide(heading_sigma, turn))
        });
        let unseen = UnseenLikelihood {
            space,
            watch,
            exponent: exponent(CLEARING_RATE * dt),
        };
        let mut teleport = Teleport::new(dt, &mut self.rng);
        let n = self.particles.len();
        for first in (0..n).step_by(BLOCK) {
            let range = first..n.min(first + BLOCK);
            let noise = &mut self.scratch.noise[..4 * range.len()];
            predict::fill(noise, &mut self.rng);
            motion.apply(self.particles.stretch(range.clone()), noise);
            let places = &mut self.scratch.places[..range.len()];
            let mut particles = self.particles.stretch(range.clone());
            let weights = &mut self.weights[range];
            if let Some(seen) = &seen {
                teleport.apply(&mut particles, &mut self.rng);
                if !is_published {
                    seen.weigh(&particles, weights);
                    weigh::drop_invalid(space, &particles, weights, places);
                }
                continue;
            }
            if self.params.turn_at_walls {
                motion.turn_at_walls(space, &mut particles, places, &mut self.rng);
            }
            teleport.apply(&mut particles, &mut self.rng);
            unseen.weigh(&particles, weights);
        }
        if let Some(m) = measurement.filter(|_| is_published) {
            published::weigh(space, &self.particles, m, &mut self.weights);
        }
    }

    fn resample(&mut self, sum: f64) {
        let count = self.len();
        // In (0, 1): a zero weight has no descendants even at the first pointer.
        let offset = (f64::from(self.rng.random::<u32>()) + 0.5) / 4_294_967_296.0;
        resample::choose(&self.weights, sum, count, offset, &mut self.scratch.starts);
        resample::copy(
            &self.particles,
            &self.scratch.starts,
            &mut self.scratch.resampled,
        );
        core::mem::swap(&mut self.particles, &mut self.scratch.resampled);
        self.weights.fill(1.0);
    }

    fn rebuild(&mut self, space: &Space, watch: &Watch, measurement: Option<&Measurement>) {
        let velocities = velocities(&self.params, self.limits);
        if let Some(m) = measurement {
            recover::around_measurement(&mut self.particles, space, m, velocities, &mut self.rng);
        } else {
            let fastest = self.limits.v_max.max(self.limits.v_reverse_max);
            let radius = RECOVERY_MARGIN + fastest * self.unseen_for;
            let reach = self.last_seen.map(|centre| (centre, radius));
            recover::over_unseen(
                &mut self.particles,
                space,
                watch,
                reach,
                velocities,
                &mut self.scratch.cells,
                &mut self.rng,
            );
        }
        self.weights.fill(1.0);
        self.effective = self.len() as f64;
    }

    /// Moves all particles to a measurement that is practically without noise. A noisy one leaves
    /// them, and their headings, to their weights.
    fn snap(&mut self, m: &Measurement) {
        if m.sigma >= SNAP_BELOW {
            return;
        }
        self.particles.x.fill(m.position.x as f32);
        self.particles.y.fill(m.position.y as f32);
        if let Some((theta, sigma)) = m.heading
            && sigma < SNAP_BELOW
        {
            self.particles.heading.fill(crate::fast::wrap(theta as f32));
        }
    }

    /// Returns the summary of the belief in one pass over the particles.
    pub fn belief(&self) -> Belief {
        let p = &self.particles;
        let (mean, [xx, xy, yy], spread) = moments(&p.x, &p.y, &p.heading, &self.weights);
        Belief {
            mean,
            covariance_xx: xx,
            covariance_xy: xy,
            covariance_yy: yy,
            heading_spread: spread,
            effective_sample_size: self.effective,
            seen: self.seen,
            unseen_for: self.unseen_for,
        }
    }

    /// The hypotheses; their weights sum to 1.
    pub fn particles(&self) -> impl ExactSizeIterator<Item = Particle> + '_ {
        let p = &self.particles;
        let share = (1.0 / weigh::totals(&self.weights).0.max(f64::MIN_POSITIVE)) as f32;
        (0..p.len()).map(move |i| Particle {
            x: p.x[i],
            y: p.y[i],
            theta: p.heading[i],
            weight: self.weights[i] * share,
        })
    }
}

fn velocities(params: &FilterParams, limits: MotionLimits) -> recover::Velocities {
    Motion::new(params, limits, 0.0).ends()
}

/// Removes the binary rounding error of rate·dt, so that 20 Hz needs no power.
fn exponent(times: f64) -> f64 {
    if (times - 1.0).abs() < 1e-9 {
        1.0
    } else {
        times
    }
}

#[cfg(test)]
mod tests;
