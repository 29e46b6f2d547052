//! Random numbers of planners, from a keyed stream.

use chaotic_maps::{KeyedStream, Source};

/// Uniform numbers in [0, 1) from the `ChaCha20` stream of a key, one after the other.
#[derive(Debug, Clone)]
pub struct Draws {
    stream: KeyedStream,
    /// Second coordinate of the last point.
    spare: Option<f64>,
}

impl Draws {
    pub(crate) fn new(key: [u8; 32]) -> Self {
        Self {
            stream: KeyedStream::new(key),
            spare: None,
        }
    }

    pub(crate) fn unit(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let [x, y] = self.stream.next_unit();
        self.spare = Some(y);
        x
    }

    /// An index below `count`; 0 if `count` is 0.
    pub(crate) fn index(&mut self, count: usize) -> usize {
        part(self.unit(), count)
    }

    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }
}

/// The index of the part, of `count` equal parts of [0, 1), that contains a number.
pub fn part(unit: f64, count: usize) -> usize {
    ((unit * count as f64) as usize).min(count.saturating_sub(1))
}
