//! The ROS 2 CDR form of a message: its shared-memory bytes after a 4-byte encapsulation header.
//!
//! CDR (little-endian, XCDR1) aligns every primitive to its size, counted from the end of the
//! encapsulation header. The messages have no implicit padding and their first field has the
//! alignment of the whole, so user header and elements are copied unchanged. Only the element count
//! of a sequence and the gap before its first element are written; an empty sequence has no gap.

use crate::topics::{Arity, Topic, TopicFacts};

/// Little-endian plain CDR.
pub const ENCAPSULATION: [u8; 4] = [0x00, 0x01, 0x00, 0x00];

/// Reason why bytes are not a message of a topic.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// The first four bytes are not those of little-endian plain CDR.
    #[error("encapsulation header is {found:02x?}: expected [00, 01, 00, 00] (little-endian CDR)")]
    Encapsulation {
        /// Actual bytes (fewer than four if the message ends there).
        found: Vec<u8>,
    },
    /// The length does not match the topic's layout.
    #[error("a message of {topic} with {elements} element(s) has {expected} bytes, found {found}")]
    Length {
        /// The topic.
        topic: &'static str,
        /// Number of elements of the message.
        elements: usize,
        /// Expected length (bytes).
        expected: usize,
        /// Actual length (bytes).
        found: usize,
    },
}

/// Appends the CDR form of a message to `out`.
pub fn encode<T: Topic>(header: &T::Header, elements: &[T::Element], out: &mut Vec<u8>) {
    use zerocopy::IntoBytes;
    let head = SequenceHead::for_topic(T::FACTS, elements.len());
    encode_bytes(header.as_bytes(), &head, elements.as_bytes(), out);
}

/// As [`encode`], of the bytes of header and elements.
pub(crate) fn encode_bytes(header: &[u8], head: &SequenceHead, elements: &[u8], out: &mut Vec<u8>) {
    out.extend_from_slice(&ENCAPSULATION);
    out.extend_from_slice(header);
    out.extend_from_slice(head.as_bytes());
    out.extend_from_slice(elements);
}

/// The bytes between user header and elements in the CDR form: for a sequence, the element count
/// and the gap before the first element; else none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SequenceHead {
    bytes: [u8; 8],
    len: usize,
}

impl SequenceHead {
    /// Creates it for a message of the topic with this number of elements.
    pub fn for_topic(topic: &TopicFacts, elements: usize) -> Self {
        // A slice in shared memory is far below 2^32 elements (`Bus` caps it).
        let [a, b, c, d] = (elements as u32).to_le_bytes();
        Self {
            bytes: [a, b, c, d, 0, 0, 0, 0],
            len: head_len(topic, elements),
        }
    }

    /// The bytes.
    pub fn as_bytes(&self) -> &[u8] {
        self.bytes.get(..self.len).unwrap_or_default()
    }
}

/// A message of a topic: its header and its elements.
pub type DecodedMessage<T> = (<T as Topic>::Header, Vec<<T as Topic>::Element>);

/// Decodes a message from its CDR form.
///
/// # Errors
/// [`DecodeError`] if the bytes are not exactly one message of the topic.
pub fn decode<T: Topic>(bytes: &[u8]) -> Result<DecodedMessage<T>, DecodeError> {
    let mut elements = Vec::new();
    let header = decode_into::<T>(bytes, &mut elements)?;
    Ok((header, elements))
}

/// As [`decode`], with the decoded elements replacing those in `elements`.
///
/// # Errors
/// As [`decode`]; then `elements` is empty.
pub fn decode_into<T: Topic>(
    bytes: &[u8],
    elements: &mut Vec<T::Element>,
) -> Result<T::Header, DecodeError> {
    use zerocopy::{FromBytes, IntoBytes};
    elements.clear();
    let body = bytes
        .strip_prefix(&ENCAPSULATION)
        .ok_or_else(|| DecodeError::Encapsulation {
            found: bytes[..bytes.len().min(4)].to_vec(),
        })?;
    let wrong = |elements: usize| DecodeError::Length {
        topic: T::NAME,
        elements,
        expected: encoded_len::<T>(elements),
        found: bytes.len(),
    };
    let (header, rest) = T::Header::read_from_prefix(body).map_err(|_| wrong(0))?;
    let (count, rest) = match T::ARITY {
        Arity::One => (1, rest),
        Arity::Many => {
            let (count, rest) = u32::read_from_prefix(rest).map_err(|_| wrong(0))?;
            let count = count as usize;
            // Logs up to release 0.2 have the gap in empty sequences, too.
            let gap = sequence_gap(T::FACTS);
            let has_gap = count > 0 || rest.len() == gap;
            let gap = if has_gap { gap } else { 0 };
            (count, rest.get(gap..).ok_or_else(|| wrong(count))?)
        }
    };
    if count.checked_mul(size_of::<T::Element>()) != Some(rest.len()) {
        return Err(wrong(count));
    }
    // The bytes of a log are not aligned: they are copied to aligned memory.
    elements.resize(count, T::Element::default());
    elements.as_mut_bytes().copy_from_slice(rest);
    Ok(header)
}

/// Reads a message in its CDR form without a copy into a vector; `None` if it is too short.
pub fn view<T: Topic>(
    bytes: &[u8],
) -> Option<(
    T::Header,
    impl ExactSizeIterator<Item = T::Element> + Clone + '_,
)> {
    use zerocopy::FromBytes;
    let (header, _) = T::Header::read_from_prefix(bytes.get(ENCAPSULATION.len()..)?).ok()?;
    let size = size_of::<T::Element>();
    let head = ENCAPSULATION.len() + size_of::<T::Header>();
    let elements = match T::ARITY {
        Arity::One => bytes.get(head..head + size)?,
        // Shorter than the head of a sequence with elements: an empty one.
        Arity::Many => {
            bytes.get(head + head_len(T::FACTS, 0)..)?;
            bytes
                .get(head + head_len(T::FACTS, 1)..)
                .unwrap_or_default()
        }
    };
    // The bytes of the log are not aligned: `read_from_bytes` copies, and all bytes are a valid
    // message.
    let elements = elements
        .chunks_exact(size)
        .map(|bytes| T::Element::read_from_bytes(bytes).unwrap_or_default());
    Some((header, elements))
}

/// Splits the CDR form of a message of a topic into the bytes of its header and of its elements, with their number; `None` if it
/// is not one message of the topic.
pub(crate) fn split<'b>(
    topic: &TopicFacts,
    bytes: &'b [u8],
) -> Option<(&'b [u8], &'b [u8], usize)> {
    let body = bytes.strip_prefix(&ENCAPSULATION)?;
    let (header, rest) = body.split_at_checked(topic.header.size)?;
    let count = match topic.arity {
        Arity::One => 1,
        Arity::Many => u32::from_le_bytes(*rest.first_chunk()?) as usize,
    };
    let elements = rest.get(head_len(topic, count)..)?;
    let is_whole = count.checked_mul(topic.element.size) == Some(elements.len());
    is_whole.then_some((header, elements, count))
}

/// Length (bytes) of the CDR form of a message with this number of elements (saturating).
pub fn encoded_len<T: Topic>(elements: usize) -> usize {
    let head = ENCAPSULATION.len() + size_of::<T::Header>() + head_len(T::FACTS, elements);
    elements
        .saturating_mul(size_of::<T::Element>())
        .saturating_add(head)
}

/// Length (bytes) of a sequence's count and gap.
pub(crate) const fn head_len(topic: &TopicFacts, elements: usize) -> usize {
    match topic.arity {
        Arity::One => 0,
        Arity::Many if elements == 0 => 4,
        Arity::Many => 4 + sequence_gap(topic),
    }
}

/// Padding between a sequence's count (which ends at 4 modulo 8) and its first element.
const fn sequence_gap(topic: &TopicFacts) -> usize {
    if topic.element.align == 8 { 4 } else { 0 }
}
