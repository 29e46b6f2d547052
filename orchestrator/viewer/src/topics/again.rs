//! When a picture that seldom changes is drawn again.
//!
//! Foxglove Studio clears its scene at a jump and asks for the last picture of every topic. If these
//! are slow to come (100 ms), or are asked for again at the same time, it clears the scene once more
//! when playing begins, without asking again: what is drawn only once would be gone from then on.

/// Least time between two drawings of the same picture (ns).
const PERIOD_NS: u64 = 2_000_000_000;

/// How much of a log, uncompressed, the same picture may take (bytes per simulated second): large
/// ones come less often, because viewers keep every message that they have read.
const BYTES_PER_SECOND: u64 = 300_000;

/// Knows when a picture is due again.
#[derive(Debug, Default)]
pub(super) struct Again {
    /// Nothing has been drawn yet if `None` (ns).
    due_ns: Option<u64>,
}

impl Again {
    /// It was drawn, in that many bytes.
    pub(super) fn drawn(&mut self, time_ns: u64, bytes: usize) {
        let nanoseconds = bytes as u128 * 1_000_000_000 / u128::from(BYTES_PER_SECOND);
        let period = u64::try_from(nanoseconds).unwrap_or(u64::MAX);
        self.due_ns = Some(time_ns.saturating_add(period.max(PERIOD_NS)));
    }

    /// Whether it should be drawn again.
    pub(super) fn is_due(&self, time_ns: u64) -> bool {
        self.due_ns.is_some_and(|due| time_ns >= due)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_pictures_come_often_large_ones_seldom_and_none_before_the_first() {
        let mut again = Again::default();
        assert!(!again.is_due(u64::MAX));
        again.drawn(1_000_000_000, 100);
        assert!(!again.is_due(2_999_999_999));
        assert!(again.is_due(3_000_000_000));
        again.drawn(3_000_000_000, 3_000_000);
        assert!(!again.is_due(12_999_999_999));
        assert!(again.is_due(13_000_000_000));
        again.drawn(u64::MAX, usize::MAX);
        assert!(!again.is_due(u64::MAX - 1));
    }
}
