//! Buffer that puts arriving messages in the order of the log.

use ipc_types::bus::AnyMessage;
use ipc_types::stamp::Stamp;
use ipc_types::topics::TopicId;

/// A pending message.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Entry {
    /// Tick at which it is written: the tick of its stamp, if plausible.
    pub(super) tick: u64,
    /// Its topic.
    pub(super) topic: TopicId,
    /// Its stamp.
    pub(super) stamp: Stamp,
    /// `true` if it failed the checks.
    pub(super) rejected: bool,
    /// Order of arrival, which orders entries that are otherwise equal.
    arrival: u64,
    start: usize,
    len: usize,
}

/// Reorder buffer of messages in their CDR form. It returns the messages of written ticks ordered by tick,
/// topic, source and sequence, independent of their arrival.
#[derive(Debug, Default)]
pub(super) struct ReorderBuffer {
    entries: Vec<Entry>,
    bytes: Vec<u8>,
    /// Size of the pending messages (bytes); a copied message may follow them.
    kept: usize,
    /// Receives the remaining messages when others are taken; swapped with `bytes`.
    spare: Vec<u8>,
    arrivals: u64,
}

impl ReorderBuffer {
    /// Copies a message from shared memory and returns its CDR form; [`ReorderBuffer::keep`] keeps it.
    pub(super) fn copy(&mut self, message: &AnyMessage<'_>) -> &[u8] {
        self.bytes.truncate(self.kept);
        message.encode(&mut self.bytes);
        &self.bytes[self.kept..]
    }

    /// Keeps the message that was copied last.
    pub(super) fn keep(&mut self, tick: u64, topic: TopicId, stamp: Stamp, rejected: bool) {
        self.entries.push(Entry {
            tick,
            topic,
            stamp,
            rejected,
            arrival: self.arrivals,
            start: self.kept,
            len: self.bytes.len() - self.kept,
        });
        self.arrivals += 1;
        self.kept = self.bytes.len();
    }

    /// Passes the messages of all ticks up to `last` (of all if `None`) to `take`, in order, and removes
    /// them.
    ///
    /// # Errors
    /// The first error of `take`; the remaining messages are lost.
    pub(super) fn take<E>(
        &mut self,
        last: Option<u64>,
        mut take: impl FnMut(&Entry, &[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        self.entries.sort_unstable_by_key(|e| {
            (e.tick, e.topic, e.stamp.source, e.stamp.sequence, e.arrival)
        });
        let ready = self
            .entries
            .partition_point(|entry| last.is_none_or(|last| entry.tick <= last));
        let mut result = Ok(());
        for entry in &self.entries[..ready] {
            result = take(entry, &self.bytes[entry.start..entry.start + entry.len]);
            if result.is_err() {
                break;
            }
        }
        self.entries.drain(..ready);
        self.spare.clear();
        for entry in &mut self.entries {
            let start = self.spare.len();
            self.spare
                .extend_from_slice(&self.bytes[entry.start..entry.start + entry.len]);
            entry.start = start;
        }
        core::mem::swap(&mut self.bytes, &mut self.spare);
        self.kept = self.bytes.len();
        result
    }

    /// Returns the size of the pending messages (bytes).
    pub(super) fn waiting_bytes(&self) -> usize {
        self.kept
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use ipc_types::cdr;
    use ipc_types::messages::robot::Command;
    use ipc_types::stamp::PlainHeader;
    use ipc_types::topics::Commands;
    use proptest::prelude::*;

    use super::*;

    fn push(
        reorder_buffer: &mut ReorderBuffer,
        rank: usize,
        tick: u64,
        source: u32,
        sequence: u64,
    ) {
        let mut header = PlainHeader::default();
        header.stamp.tick = tick;
        header.stamp.source = source;
        header.stamp.sequence = sequence;
        let command = Command {
            v: (tick * 100 + u64::from(source)) as f64,
            ..Command::default()
        };
        reorder_buffer.copy(&AnyMessage::new::<Commands>(&header, &[command]));
        reorder_buffer.keep(tick, TopicId::all().nth(rank).unwrap(), header.stamp, false);
    }

    fn take(
        reorder_buffer: &mut ReorderBuffer,
        completed: Option<u64>,
    ) -> Vec<(u64, usize, u32, u64)> {
        let mut out = Vec::new();
        let Ok(()) = reorder_buffer.take::<Infallible>(completed, |entry, bytes| {
            let (_, commands) = cdr::decode::<Commands>(bytes).unwrap();
            let expected = entry.tick * 100 + u64::from(entry.stamp.source);
            assert_eq!(
                commands[0].v, expected as f64,
                "the bytes belong to the entry"
            );
            out.push((
                entry.tick,
                entry.topic.rank(),
                entry.stamp.source,
                entry.stamp.sequence,
            ));
            Ok(())
        });
        out
    }

    #[test]
    fn complete_ticks_are_taken_in_order_and_the_rest_stays() {
        let mut reorder_buffer = ReorderBuffer::default();
        for (topic, tick, source, sequence) in [
            (7, 2, 3, 0),
            (7, 1, 3, 0),
            (0, 2, 0, 1),
            (0, 1, 0, 0),
            (7, 1, 2, 0),
            (7, 1, 2, 1),
        ] {
            push(&mut reorder_buffer, topic, tick, source, sequence);
        }
        assert_eq!(take(&mut reorder_buffer, Some(0)), []);
        assert_eq!(
            take(&mut reorder_buffer, Some(1)),
            [(1, 0, 0, 0), (1, 7, 2, 0), (1, 7, 2, 1), (1, 7, 3, 0)]
        );
        assert!(reorder_buffer.waiting_bytes() > 0);
        assert_eq!(
            take(&mut reorder_buffer, None),
            [(2, 0, 0, 1), (2, 7, 3, 0)]
        );
        assert_eq!(reorder_buffer.waiting_bytes(), 0);
    }

    proptest! {
        #[test]
        fn the_order_does_not_depend_on_arrival_or_batches(
            keys in proptest::collection::btree_set((0_u64..6, 0_usize..3, 0_u32..3), 1..40),
            shuffle in any::<u64>(),
            cut in 0_usize..40,
        ) {
            let sorted: Vec<_> = keys.iter().map(|&(t, r, s)| (t, r, s, t)).collect();
            let mut arrival: Vec<_> = keys.into_iter().collect();
            let mut state = shuffle | 1;
            for i in (1..arrival.len()).rev() {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                arrival.swap(i, (state >> 33) as usize % (i + 1));
            }
            let mut reorder_buffer = ReorderBuffer::default();
            let cut = cut.min(arrival.len());
            for &(tick, topic, source) in &arrival[..cut] {
                push(&mut reorder_buffer, topic, tick, source, tick);
            }
            // A tick is complete if no earlier message can follow.
            let completed = arrival[cut..].iter().map(|k| k.0).min();
            let mut out = match completed {
                Some(0) => Vec::new(),
                Some(tick) => take(&mut reorder_buffer, Some(tick - 1)),
                None => take(&mut reorder_buffer, None),
            };
            for &(tick, topic, source) in &arrival[cut..] {
                push(&mut reorder_buffer, topic, tick, source, tick);
            }
            out.extend(take(&mut reorder_buffer, None));
            prop_assert_eq!(out, sorted);
        }
    }
}
