//! Repetition of pictures that seldom change.
//!
//! Foxglove Studio clears its scene after a seek and requests the last picture of every topic. If these
//! arrive late (100 ms) or are requested again at the same time, it clears the scene once more when playback
//! begins, without a new request. A picture that is drawn only once would stay invisible.

/// Minimum time between two messages with the same picture (simulated ns).
const PERIOD_NS: u64 = 2_000_000_000;

/// Maximum data rate of a repeated picture (uncompressed bytes per simulated second): larger pictures are
/// repeated less often, because viewers keep every message that they have read.
const BYTES_PER_SECOND: u64 = 300_000;

/// Schedule of the repetitions of a picture.
#[derive(Debug, Default)]
pub(super) struct Repetition {
    /// Time of the next repetition (simulated ns); `None` before the first drawing.
    due_ns: Option<u64>,
}

impl Repetition {
    /// Records a drawing of this size (bytes).
    pub(super) fn drawn(&mut self, time_ns: u64, bytes: usize) {
        let nanoseconds = bytes as u128 * 1_000_000_000 / u128::from(BYTES_PER_SECOND);
        let period = u64::try_from(nanoseconds).unwrap_or(u64::MAX);
        self.due_ns = Some(time_ns.saturating_add(period.max(PERIOD_NS)));
    }

    /// Returns `true` if the picture is due again.
    pub(super) fn is_due(&self, time_ns: u64) -> bool {
        self.due_ns.is_some_and(|due| time_ns >= due)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_pictures_repeat_often_large_ones_seldom_and_none_before_the_first() {
        let mut repetition = Repetition::default();
        assert!(!repetition.is_due(u64::MAX));
        repetition.drawn(1_000_000_000, 100);
        assert!(!repetition.is_due(2_999_999_999));
        assert!(repetition.is_due(3_000_000_000));
        repetition.drawn(3_000_000_000, 3_000_000);
        assert!(!repetition.is_due(12_999_999_999));
        assert!(repetition.is_due(13_000_000_000));
        repetition.drawn(u64::MAX, usize::MAX);
        assert!(!repetition.is_due(u64::MAX - 1));
    }
}
