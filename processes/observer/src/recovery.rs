//! Recovery of the state of the linear maps from their points, with the method known.
//!
//! Fewer than a hundred consecutive points of a cat map, or thirty of a Chebyshev map, observed
//! with noise of up to 2 % of the side, determine its integer state exactly. From then on every
//! point is known in advance. [`cat::CatRecovery`] and [`chebyshev::ChebyshevRecovery`] accept one
//! observation at a time. They report a state only if an exact orbit agrees with a whole window of
//! observations, several of which were not used for the estimate. A [`chaotic_maps::KeyedStream`] stream
//! offers nothing to recover.

pub mod cat;
pub mod chebyshev;

use chaotic_maps::{AnySource, Source as _};

/// Maximum number of consecutive observations that a recovered orbit may miss before it is dropped:
/// one may be a sensor error.
const MAX_MISSES: u32 = 3;

/// Recovered orbit, synchronised with the observations.
#[derive(Debug, Clone)]
struct OrbitTrack {
    source: AnySource,
    misses: u32,
}

impl OrbitTrack {
    fn new(source: AnySource) -> Self {
        Self { source, misses: 0 }
    }

    /// Advances to the next point and returns `true` if the orbit is still valid; `agrees` compares
    /// that point, in [−1, 1]², with the observation (if any).
    fn follow(&mut self, agrees: impl FnOnce([f64; 2]) -> bool) -> bool {
        if agrees(self.source.next_symmetric()) {
            self.misses = 0;
        } else {
            self.misses += 1;
        }
        self.misses < MAX_MISSES
    }
}

#[cfg(test)]
mod tests;
