//! A keyed stream: points that cannot be predicted without the key, even with knowledge of the
//! method.

use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha20Rng;

use crate::source::Source;

/// Number of 32-bit words per point: two coordinates of 64 bits.
const WORDS: u128 = 4;

/// Independent uniform points from a `ChaCha20` stream; a holder of the 32-byte key can compute
/// each of them at once.
#[derive(Debug, Clone)]
pub struct KeyedStream {
    stream: ChaCha20Rng,
}

impl KeyedStream {
    /// Creates the stream of a key, before its first point.
    pub fn new(key: [u8; 32]) -> Self {
        Self {
            stream: ChaCha20Rng::from_seed(key),
        }
    }

    /// The same stream, moved so that the next point is number `step` (the first is number 0).
    #[must_use]
    pub fn at(&self, step: u64) -> Self {
        let mut moved = self.clone();
        moved.stream.set_word_pos(u128::from(step) * WORDS);
        moved
    }

    /// Number of the next point.
    pub fn step(&self) -> u64 {
        (self.stream.get_word_pos() / WORDS) as u64
    }

    /// Skips `steps` points, in constant time.
    pub fn advance(&mut self, steps: u64) {
        *self = self.at(self.step().wrapping_add(steps));
    }
}

/// A uniform number in [0, 1) of 53 bits.
fn uniform(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

impl Source for KeyedStream {
    fn next_unit(&mut self) -> [f64; 2] {
        let x = uniform(self.stream.next_u64());
        [x, uniform(self.stream.next_u64())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_point_of_the_stream_can_be_reached_at_once() {
        let start = KeyedStream::new([7; 32]);
        let mut walked = start.clone();
        let points: Vec<_> = (0..100).map(|_| walked.next_unit()).collect();
        for step in [0, 1, 2, 17, 63, 99] {
            let mut moved = start.at(step);
            assert_eq!(moved.step(), step);
            assert_eq!(moved.next_unit(), points[step as usize]);
            let mut advanced = start.clone();
            advanced.advance(step);
            assert_eq!(advanced.next_unit(), points[step as usize]);
        }
        assert_eq!(walked.step(), 100);
    }

    #[test]
    fn the_stream_is_chacha20_of_the_key() {
        // RFC 8439 and the reference implementation: the stream of the zero key and nonce begins
        // 76 b8 e0 ad a0 f1 3d 90.
        let mut stream = KeyedStream::new([0; 32]);
        let first = u64::from_le_bytes([0x76, 0xb8, 0xe0, 0xad, 0xa0, 0xf1, 0x3d, 0x90]);
        assert_eq!(stream.next_unit()[0], uniform(first));
    }

    #[test]
    fn different_keys_give_different_points_of_uniform_spread() {
        let (mut one, mut other) = (KeyedStream::new([1; 32]), KeyedStream::new([2; 32]));
        let mut counts = [0_u32; 16];
        for _ in 0..16_000 {
            let p = one.next_unit();
            assert_ne!(p, other.next_unit());
            counts[(p[0] * 4.0) as usize * 4 + (p[1] * 4.0) as usize] += 1;
        }
        let chi2: f64 = counts
            .iter()
            .map(|&n| (f64::from(n) - 1000.0).powi(2) / 1000.0)
            .sum();
        // 15 degrees of freedom; the 99.99 % quantile is 44.3.
        assert!(chi2 < 44.3, "{chi2}");
    }
}
