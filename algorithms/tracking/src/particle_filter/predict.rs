//! Motion of the hypotheses: a unicycle whose speed and turning rate walk randomly within the
//! opponent's limits, and rare jumps.

use geometry::math;
use parameters::Fidelity;
use rand::{Rng, RngExt};
use rand_chacha::ChaCha8Rng;

use super::cloud::Stretch;
use crate::fast;
use crate::motion_limits::MotionLimits;
use crate::params::FilterParams;
use crate::space::Space;

/// Extent of the random walks beyond the maximum speed and turning rates, as a share of the range of
/// speeds and of the turning rates to one side. Beyond the limit a hypothesis moves at the limit, as
/// robots often do.
const SATURATION: f64 = 0.25;

/// One tick's motion in single precision.
#[derive(Debug, Clone, Copy)]
pub struct Motion {
    dt: f32,
    /// Half-widths of the uniform steps of v and ω.
    step_v: f32,
    step_omega: f32,
    v_low: f32,
    v_high: f32,
    omega_high: f32,
    /// Ends of the walks: beyond `v_high` and `omega_high` the particle moves at the limit.
    v_top: f32,
    omega_top: f32,
    /// Fraction of the distance to the cruising speed that remains after a tick, and the resulting
    /// offset.
    v_keep: f32,
    v_pull: f32,
    /// Fraction of the turning rate that remains after a tick.
    omega_keep: f32,
    /// Factor of the correction of an overshoot over a limit: 2 reflects, 1 clamps.
    rebound: f32,
}

impl Motion {
    /// Uniform steps of half-width √(3 dt)·(walk): the variance per second does not depend on dt.
    pub fn new(params: &FilterParams, limits: MotionLimits, dt: f64) -> Self {
        let spread = (3.0 * dt).sqrt();
        let (v_low, v_high) = (-limits.v_reverse_max, limits.v_max);
        // The published program's walks stay at the limits: the number of particles there then
        // depends on the tick rate.
        let (saturation, rebound) = match params.fidelity {
            Fidelity::Ours => (SATURATION, 2.0),
            Fidelity::Published => (0.0, 1.0),
        };
        let largest = v_high.max(-v_low);
        let v_keep = math::exp(-params.cruise_rate * dt);
        Self {
            dt: dt as f32,
            step_v: (params.speed_walk * largest * spread) as f32,
            step_omega: (params.turn_walk * limits.omega_max * spread) as f32,
            v_low: v_low as f32,
            v_high: v_high as f32,
            omega_high: limits.omega_max as f32,
            v_top: (v_high + saturation * (v_high - v_low)) as f32,
            omega_top: (limits.omega_max * (1.0 + saturation)) as f32,
            v_keep: v_keep as f32,
            v_pull: ((1.0 - v_keep) * v_high) as f32,
            omega_keep: math::exp(-params.straighten_rate * dt) as f32,
            rebound,
        }
    }

    /// The same motion without noise.
    pub fn quiet(self) -> Self {
        Self {
            step_v: 0.0,
            step_omega: 0.0,
            ..self
        }
    }

    /// Ends of the walks: lowest and highest v (m/s), highest |ω| (rad/s).
    pub fn ends(&self) -> (f32, f32, f32) {
        (self.v_low, self.v_top, self.omega_top)
    }

    /// Moves every particle by one tick. `noise` has four random bytes per particle: 16 bits each
    /// for v and ω. The step along the arc is taken in the direction of its middle, which is exact
    /// up to (ω·dt)²/24 of its length.
    pub fn apply(&self, particles: Stretch<'_>, noise: &[u8]) {
        let Stretch {
            x,
            y,
            heading,
            v,
            omega,
        } = particles;
        let n = x.len();
        let (y, heading, v, omega) = (&mut y[..n], &mut heading[..n], &mut v[..n], &mut omega[..n]);
        let (words, _) = noise.as_chunks::<4>();
        let words = &words[..n];
        let unit = 1.0 / 32_768.0;
        let (step_v, step_omega) = (self.step_v * unit, self.step_omega * unit);
        for i in 0..n {
            let word = u32::from_le_bytes(words[i]);
            let (low, high) = ((word & 0xffff) as i32, (word >> 16) as i32);
            // Symmetric about 0: −32767.5 … 32767.5.
            let a = low as f32 - 32_767.5;
            let b = high as f32 - 32_767.5;
            let drawn_v = v[i] * self.v_keep + self.v_pull + a * step_v;
            v[i] = self.bounded(drawn_v, self.v_low, self.v_top);
            let drawn_omega = omega[i] * self.omega_keep + b * step_omega;
            omega[i] = self.bounded(drawn_omega, -self.omega_top, self.omega_top);
            let speed = v[i].min(self.v_high);
            let rate = omega[i].max(-self.omega_high).min(self.omega_high);
            let half_turn = 0.5 * self.dt * rate;
            let middle = heading[i] + half_turn;
            let (sin, cos) = fast::sincos(middle);
            let step = speed * self.dt;
            x[i] += step * cos;
            y[i] += step * sin;
            heading[i] = fast::wrap(middle + half_turn);
        }
    }

    #[inline]
    fn bounded(&self, value: f32, low: f32, high: f32) -> f32 {
        let above = (value - high).max(0.0);
        let below = (low - value).max(0.0);
        // The clamp handles steps that are longer than the whole range.
        (value + self.rebound * (below - above)).max(low).min(high)
    }
}

/// Maximum change of the heading of a hypothesis that turns away from an obstacle (rad): it may turn
/// back, but rarely.
const TURN_AWAY: f64 = 2.2;

impl Motion {
    /// Moves particles that the last motion brought into an obstacle back and turns them randomly.
    ///
    /// `places` is working memory, one per particle.
    pub fn turn_at_walls(
        &self,
        space: &Space,
        particles: &mut Stretch<'_>,
        places: &mut [u32],
        rng: &mut ChaCha8Rng,
    ) {
        space.locate(particles.x, particles.y, places);
        for (i, &place) in places.iter().enumerate() {
            if space.valid_at(place) != 0 {
                continue;
            }
            let (sin, cos) = fast::sincos(particles.heading[i]);
            let back = particles.v[i].min(self.v_high) * self.dt;
            particles.x[i] -= back * cos;
            particles.y[i] -= back * sin;
            let turn = TURN_AWAY * (2.0 * rng.random::<f64>() - 1.0);
            particles.heading[i] = fast::wrap(particles.heading[i] + turn as f32);
            particles.omega[i] = 0.0;
        }
    }
}

/// Rate at which a particle jumps to a nearby pose (1/s).
const JUMP_RATE: f64 = 0.25;

/// Maximum jump in x and in y (m).
const JUMP_DISTANCE: f64 = 1.0;

/// Maximum jump of the heading (rad).
const JUMP_TURN: f64 = 0.5;

/// Rare jumps to nearby poses, with which a collapsed belief recovers (chasing-game paper, section
/// III.D). The gaps between jumping particles are drawn, not one number per particle.
#[derive(Debug, Clone, Copy)]
pub struct Teleport {
    /// ln(1 − probability of a jump in this tick).
    log_stay: f64,
    /// Particles to skip until the next jump.
    gap: u64,
}

impl Teleport {
    pub fn new(dt: f64, rng: &mut ChaCha8Rng) -> Self {
        let mut teleport = Self {
            // The probability is 1 − exp(−rate·dt).
            log_stay: -JUMP_RATE * dt,
            gap: 0,
        };
        teleport.gap = teleport.draw_gap(rng);
        teleport
    }

    fn draw_gap(&self, rng: &mut ChaCha8Rng) -> u64 {
        // Geometric distribution by inversion; `as` saturates.
        (math::ln(1.0 - rng.random::<f64>()) / self.log_stay) as u64
    }

    /// Applies the due jumps to the particles of a range.
    pub fn apply(&mut self, particles: &mut Stretch<'_>, rng: &mut ChaCha8Rng) {
        let n = particles.x.len() as u64;
        let mut i = self.gap;
        while i < n {
            let at = i as usize;
            let mut within = |half: f64| (half * (2.0 * rng.random::<f64>() - 1.0)) as f32;
            particles.x[at] += within(JUMP_DISTANCE);
            particles.y[at] += within(JUMP_DISTANCE);
            particles.heading[at] = fast::wrap(particles.heading[at] + within(JUMP_TURN));
            i = i.saturating_add(1).saturating_add(self.draw_gap(rng));
        }
        self.gap = i - n;
    }
}

/// Fills `noise` with random bytes.
pub fn fill(noise: &mut [u8], rng: &mut ChaCha8Rng) {
    rng.fill_bytes(noise);
}
