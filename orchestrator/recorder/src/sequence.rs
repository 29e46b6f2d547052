//! Losses, seen in the sequence numbers.

use std::collections::BTreeMap;

/// Expects the messages of every source of one topic to be numbered without gaps from 0.
#[derive(Debug, Default)]
pub(super) struct Sequences {
    next: BTreeMap<u32, u64>,
}

impl Sequences {
    /// How many messages of the source are missing before this one.
    ///
    /// A number that was expected earlier is not a loss: the source was restarted and counts from
    /// the beginning again.
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
