//! What an observer who knows the method learns from the points: the state of the linear maps.
//!
//! Fewer than a hundred consecutive points of a cat map, or thirty of a Chebyshev map, seen with
//! noise of up to 2 % of the side, determine its integer state exactly; from then on every point is
//! known in advance. [`cat::CatRecovery`] and [`chebyshev::ChebyshevRecovery`] take one observation
//! at a time and claim nothing before an exact orbit agrees with a whole window of observations,
//! among them several that took no part in the estimate. From a [`chaotic_maps::Keyed`] stream there is
//! nothing to recover.

pub mod cat;
pub mod chebyshev;

use chaotic_maps::{AnySource, Source as _};

/// Observations in a row that a recovered orbit may miss before the claim is given up: one may be an
/// error of the sensor.
const MAX_MISSES: u32 = 3;

/// A recovered orbit, kept in step with the observations.
#[derive(Debug, Clone)]
struct Tracked {
    source: AnySource,
    misses: u32,
}

impl Tracked {
    fn new(source: AnySource) -> Self {
        Self { source, misses: 0 }
    }

    /// Moves on to the next point and says whether the claim stands; `agrees` compares that point,
    /// in [−1, 1]², with what was observed (if anything).
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
