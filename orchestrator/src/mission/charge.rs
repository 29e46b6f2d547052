//! The processes of a run as their supervisor sees them.

use std::time::Instant;

/// A process as its supervisor sees it.
#[derive(Debug)]
pub(super) struct Charge {
    pub(super) standing: Standing,
    pub(super) failures: u32,
    /// Ticks done at the last look that found more of them.
    pub(super) done: u64,
    /// When that was.
    pub(super) since: Instant,
}

/// How a process stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Standing {
    /// It takes part.
    Present,
    /// It is to be started again at this time.
    Away { due: Instant },
    /// It has been started again, and must be ready by then.
    Starting { until: Instant },
    /// It will not come back.
    Gone,
}
