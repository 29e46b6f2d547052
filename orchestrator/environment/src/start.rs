//! Begins of episodes.

use crate::shared::Variant;

/// Begin of an episode by a reset; by default the next one.
#[derive(Debug, Clone, Default)]
pub struct Start {
    /// Seed of this and all following episodes, and the index of the instance among those that share the seed.
    pub first: Option<(u64, usize)>,
    /// Scenario of this and all following episodes.
    pub variant: Option<Variant>,
}
