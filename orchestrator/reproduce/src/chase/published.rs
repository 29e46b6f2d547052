//! The published results.
//!
//! They are read from the bars of the paper's figures. All are multiples of 0.1, and the number of
//! games is not given: each is taken as out of ten. The error bars of the figures are a tenth of
//! each bar, whatever the number of games, and are not used.

use statistics::{Interval, Sample, wilson};

use super::evidence::same;
use crate::statistics::fisher_exact;

/// Assumed number of games of each published value.
pub(super) const GAMES: u64 = 10;

/// Names of the methods in our experiments.
pub(super) const BRAITENBERG: &str = "braitenberg";
pub(super) const FIELD: &str = "potential_field";
pub(super) const LINE: &str = "rrt_star_line";
pub(super) const EXACT: &str = "exact";
pub(super) const FILTER: &str = "particle_filter";

/// A published value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Published {
    pub(super) method: &'static str,
    pub(super) ratio: f64,
    /// Escapes in [`GAMES`] games.
    pub(super) escaped: u64,
}

impl Published {
    /// Returns the share of evaders that escape.
    pub(super) fn share(&self) -> f64 {
        self.escaped as f64 / GAMES as f64
    }

    /// Returns the 95 % interval of the chance (Wilson).
    pub(super) fn interval(&self) -> Interval {
        wilson(self.escaped, GAMES)
    }

    /// Returns the p-value of the hypothesis that our games have the same chance: Fisher's exact test.
    pub(super) fn alike(&self, ours: &Sample) -> f64 {
        // The effective size is a number of independent outcomes.
        let size = ours.effective_size().round();
        let hits = (size * ours.share().unwrap_or(0.0)).round();
        fisher_exact((hits as u64, size as u64), (self.escaped, GAMES))
    }
}

const fn value(method: &'static str, ratio: f64, escaped: u64) -> Published {
    Published {
        method,
        ratio,
        escaped,
    }
}

/// Fig. 2: three methods against Police with exact knowledge.
pub(super) const SPEED: [Published; 12] = [
    value(BRAITENBERG, 1.5, 0),
    value(BRAITENBERG, 2.0, 0),
    value(BRAITENBERG, 2.5, 0),
    value(BRAITENBERG, 3.0, 1),
    value(FIELD, 1.5, 2),
    value(FIELD, 2.0, 7),
    value(FIELD, 2.5, 5),
    value(FIELD, 3.0, 5),
    value(LINE, 1.5, 6),
    value(LINE, 2.0, 8),
    value(LINE, 2.5, 7),
    value(LINE, 3.0, 7),
];

/// Fig. 3: knowledge of the Police. The method is not stated; RRT* fits the paper's conclusion
/// about its critical speed.
pub(super) const KNOWLEDGE: [Published; 6] = [
    value(EXACT, 0.8, 0),
    value(EXACT, 0.9, 2),
    value(EXACT, 1.0, 2),
    value(FILTER, 0.8, 3),
    value(FILTER, 0.9, 6),
    value(FILTER, 1.0, 8),
];

/// The speeds of Fig. 2.
pub(super) const SPEED_RATIOS: [f64; 4] = [1.5, 2.0, 2.5, 3.0];
/// The speeds of Fig. 3.
pub(super) const KNOWLEDGE_RATIOS: [f64; 3] = [0.8, 0.9, 1.0];

/// Returns the published value of a method at a speed.
pub(super) fn find(values: &[Published], method: &str, ratio: f64) -> Option<Published> {
    let mut values = values.iter().copied();
    values.find(|v| v.method == method && same(v.ratio, ratio))
}
