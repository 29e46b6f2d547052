//! Random numbers that are the same on every machine and in every order of requests.

use core::f64::consts::TAU;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use geometry::math;

/// Number of 32-bit words that one tick of a stream may use; a stream at tick *k* starts *k* times
/// as far in.
const WORDS_PER_TICK: u128 = 1 << 20;

/// The random numbers of one purpose at one tick.
///
/// A stream is addressed by (seed, stream number, tick) rather than kept, so that the draws of a
/// sensor do not depend on other draws or on the number of requests.
///
/// ```
/// use sim_backend::random::Stream;
///
/// let (seed, stream, tick) = (7, 3, 100);
/// let mut noise = Stream::new(seed, stream, tick);
/// let first = noise.normal();
/// assert_ne!(first, noise.normal());
/// assert_eq!(first, Stream::new(seed, stream, tick).normal());
/// ```
#[derive(Debug, Clone)]
pub struct Stream {
    rng: ChaCha8Rng,
    spare: Option<f64>,
}

impl Stream {
    /// Creates the numbers of a stream at a tick.
    pub fn new(seed: u64, stream: u64, tick: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        rng.set_word_pos(u128::from(tick) * WORDS_PER_TICK);
        Self { rng, spare: None }
    }

    /// Returns a number uniform in (0, 1].
    pub fn uniform(&mut self) -> f64 {
        // 53 bits: every multiple of 2⁻⁵³ is a double.
        ((self.rng.next_u64() >> 11) + 1) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Returns a standard normal number (Box and Muller's method; both numbers of a pair are used).
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * math::ln(self.uniform())).sqrt();
        let (sin, cos) = math::sincos(TAU * self.uniform());
        self.spare = Some(radius * sin);
        radius * cos
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_numbers_have_mean_0_and_variance_1() {
        let mut stream = Stream::new(7, 3, 11);
        let n = 100_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..n {
            let x = stream.normal();
            assert!(x.is_finite());
            sum += x;
            squares += x * x;
        }
        assert!((sum / f64::from(n)).abs() < 0.02);
        assert!((squares / f64::from(n) - 1.0).abs() < 0.02);
    }

    #[test]
    fn streams_and_ticks_differ_and_repeat() {
        let draw = |seed, stream, tick| Stream::new(seed, stream, tick).uniform();
        assert_eq!(draw(1, 2, 3), draw(1, 2, 3));
        assert_ne!(draw(1, 2, 3), draw(1, 2, 4));
        assert_ne!(draw(1, 2, 3), draw(1, 3, 3));
        assert_ne!(draw(1, 2, 3), draw(2, 2, 3));
    }
}
