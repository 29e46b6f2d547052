//! A message as the bytes of its CDR form, in pieces wherever they lie.

use ipc_types::cdr::SequenceHead;
use ipc_types::stamp::Stamp;
use ipc_types::topics::TopicId;

/// Bytes of the encapsulation header.
const ENCAPSULATION: usize = 4;

/// The pieces of a message behind its encapsulation header.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parts<'a> {
    /// User header.
    pub(super) header: &'a [u8],
    /// See [`SequenceHead`].
    pub(super) head: &'a [u8],
    /// Elements.
    pub(super) elements: &'a [u8],
    /// How many elements.
    pub(super) count: usize,
}

impl<'a> Parts<'a> {
    /// Of a message with `count` elements in its CDR form.
    pub(super) fn of_cdr(topic: TopicId, bytes: &'a [u8], count: usize) -> Self {
        let facts = topic.facts();
        let body = bytes.get(ENCAPSULATION..).unwrap_or_default();
        let (header, rest) = body.split_at(facts.header.size.min(body.len()));
        let elements = count.saturating_mul(facts.element.size).min(rest.len());
        let (head, elements) = rest.split_at(rest.len() - elements);
        Self {
            header,
            head,
            elements,
            count,
        }
    }

    /// Of a message in memory.
    pub(super) fn new(
        header: &'a [u8],
        head: &'a SequenceHead,
        elements: &'a [u8],
        count: usize,
    ) -> Self {
        Self {
            header,
            head: head.as_bytes(),
            elements,
            count,
        }
    }

    /// Bytes of the CDR form.
    pub(super) fn cdr_len(&self) -> usize {
        ENCAPSULATION + self.header.len() + self.head.len() + self.elements.len()
    }

    /// The length that the fingerprint knows a message by: as if stamps had the clocks that they had
    /// when fingerprints began, so that a clock more or less is not another history.
    pub(super) fn history_len(&self) -> usize {
        const CLOCKS: usize = size_of::<Stamp>() - Stamp::SIMULATED_BYTES;
        const CLOCKS_AT_FIRST: usize = 3 * size_of::<u64>();
        self.cdr_len().saturating_sub(CLOCKS) + CLOCKS_AT_FIRST
    }

    /// The pieces that belong to the simulated history, in order.
    pub(super) fn without_clocks(&self) -> [&'a [u8]; 4] {
        [
            self.header
                .get(..Stamp::SIMULATED_BYTES)
                .unwrap_or_default(),
            self.header.get(size_of::<Stamp>()..).unwrap_or_default(),
            self.head,
            self.elements,
        ]
    }
}
