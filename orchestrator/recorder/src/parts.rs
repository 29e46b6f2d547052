//! A message as slices of its CDR form.

use ipc_types::bus::AnyMessage;
use ipc_types::cdr::SequenceHead;
use ipc_types::stamp::Stamp;
use ipc_types::topics::{Arity, TopicId};

/// Size of the encapsulation header (bytes).
const ENCAPSULATION: usize = 4;

/// Slices of a message after its encapsulation header.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parts<'a> {
    /// User header.
    pub(super) header: &'a [u8],
    /// See [`SequenceHead`].
    pub(super) head: &'a [u8],
    /// Gap of an empty sequence: not part of the message, but of the digest since its first version.
    gap: &'static [u8],
    /// Elements.
    pub(super) elements: &'a [u8],
    /// Number of elements.
    pub(super) count: usize,
}

impl<'a> Parts<'a> {
    /// Returns the slices of a message with `count` elements in its CDR form.
    pub(super) fn of_cdr(topic: TopicId, bytes: &'a [u8], count: usize) -> Self {
        let facts = topic.facts();
        let body = bytes.get(ENCAPSULATION..).unwrap_or_default();
        let (header, rest) = body.split_at(facts.header.size.min(body.len()));
        let elements = count.saturating_mul(facts.element.size).min(rest.len());
        let (head, elements) = rest.split_at(rest.len() - elements);
        Self {
            header,
            head,
            gap: missing_gap(topic, head),
            elements,
            count,
        }
    }

    /// Returns the slices of a message in memory.
    pub(super) fn new(message: &AnyMessage<'a>, head: &'a SequenceHead) -> Self {
        let head = head.as_bytes();
        Self {
            header: message.header,
            head,
            gap: missing_gap(message.topic, head),
            elements: message.elements,
            count: message.count,
        }
    }

    /// Returns the size of the CDR form (bytes).
    pub(super) fn cdr_len(&self) -> usize {
        ENCAPSULATION + self.header.len() + self.head.len() + self.elements.len()
    }

    /// Returns the length that enters the digest: with the clock fields of the first version of stamps, so
    /// that additional clock fields do not change digests.
    pub(super) fn history_len(&self) -> usize {
        const CLOCKS: usize = size_of::<Stamp>() - Stamp::SIMULATED_BYTES;
        const CLOCKS_AT_FIRST: usize = 3 * size_of::<u64>();
        (self.cdr_len() + self.gap.len()).saturating_sub(CLOCKS) + CLOCKS_AT_FIRST
    }

    /// Returns the slices that belong to the simulated history, in order.
    pub(super) fn without_clocks(&self) -> [&'a [u8]; 5] {
        [
            self.header
                .get(..Stamp::SIMULATED_BYTES)
                .unwrap_or_default(),
            self.header.get(size_of::<Stamp>()..).unwrap_or_default(),
            self.head,
            self.gap,
            self.elements,
        ]
    }
}

/// Returns the gap that the head of a sequence has only before elements.
fn missing_gap(topic: TopicId, head: &[u8]) -> &'static [u8] {
    let facts = topic.facts();
    let is_short = facts.arity == Arity::Many && facts.element.align == 8 && head.len() == 4;
    if is_short { &[0; 4] } else { &[] }
}
