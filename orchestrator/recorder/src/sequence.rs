//! Detection of losses by sequence numbers.

use std::collections::BTreeMap;

/// Sequence numbers of one topic; those of every source count from 0 without gaps.
#[derive(Debug, Default)]
pub(super) struct Sequences {
    next: BTreeMap<u32, u64>,
}

impl Sequences {
    /// Returns the number of messages of the source that are missing before this one.
    ///
    /// A smaller number than expected is not a loss: the source was restarted and counts from 0 again.
    pub(super) fn missing(&mut self, source: u32, sequence: u64) -> u64 {
        let next = self.next.entry(source).or_insert(0);
        let missing = sequence.saturating_sub(*next);
        *next = sequence.saturating_add(1);
        missing
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_counted_per_source_and_restarts_are_not_gaps() {
        let mut sequences = Sequences::default();
        let missing: Vec<u64> = [(1, 0), (1, 1), (2, 2), (1, 5), (1, 0), (1, 1), (2, 3)]
            .map(|(source, sequence)| sequences.missing(source, sequence))
            .to_vec();
        assert_eq!(missing, [0, 0, 2, 3, 0, 0, 0]);
        assert_eq!(sequences.missing(3, u64::MAX), u64::MAX);
        assert_eq!(sequences.missing(3, u64::MAX), 0);
    }
}
