//! Messages that our recorder put by while the world stood still. They count only if the file ends
//! before they stand in a chunk.

use std::collections::BTreeSet;
use std::ops::Range;

use mcap::records::MessageHeader;

use super::Reader;
use super::chunk::{Kind, OpenChunk};

/// What was put by since the last whole chunk.
pub(super) struct PutBy {
    /// Where that stands in the file.
    at: u64,
    /// `Message` records, as in a chunk.
    records: Vec<u8>,
    /// Those of them, and others, that stood in the chunk in which the file ends.
    salvaged: BTreeSet<Key>,
}

/// Tells a message from every other: channel, sequence, time, checksum of its bytes.
type Key = (u16, u32, u64, u32);

fn key(header: &MessageHeader, data: &[u8]) -> Key {
    let crc = crc32fast::hash(data);
    (header.channel_id, header.sequence, header.log_time, crc)
}

impl Reader<'_> {
    /// Keeps the record in the buffer, in place of an earlier one, of which it holds everything. One
    /// whose checksum does not fit is not ours or damaged, and is nothing that was promised.
    pub(super) fn keep_put_by(&mut self, place: Range<usize>, at: u64) {
        let body = self.buffer.get(place).unwrap_or_default();
        if let Some((crc, records)) = body.split_first_chunk()
            && crc32fast::hash(records) == u32::from_le_bytes(*crc)
        {
            self.put_by = Some(PutBy {
                at,
                records: records.to_vec(),
                salvaged: BTreeSet::new(),
            });
        }
    }

    /// A message stood in the chunk in which the file ends: it is not handed out a second time.
    pub(super) fn note_salvaged(&mut self, header: &MessageHeader, place: Range<usize>) {
        if let Some(put_by) = &mut self.put_by {
            let data = self.buffer.get(place).unwrap_or_default();
            put_by.salvaged.insert(key(header, data));
        }
    }

    /// Where the file ends, goes on with what was put by; false if nothing was.
    pub(super) fn open_put_by(&mut self) -> bool {
        let Some(put_by) = &mut self.put_by else {
            return false;
        };
        let (at, records) = (put_by.at, core::mem::take(&mut put_by.records));
        if records.is_empty() {
            self.put_by = None;
            return false;
        }
        self.buffer = records;
        self.chunk = Some(OpenChunk::new(at, Kind::PutBy));
        true
    }

    /// Counts a message that was put by; false if it has been handed out already.
    pub(super) fn count_put_by(&mut self, header: &MessageHeader, place: Range<usize>) -> bool {
        let data = self.buffer.get(place).unwrap_or_default();
        let known = self
            .put_by
            .as_ref()
            .is_some_and(|put_by| put_by.salvaged.contains(&key(header, data)));
        if !known {
            self.condition.put_by += 1;
        }
        !known
    }
}
